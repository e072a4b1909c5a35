"""Objects of drives that are read and written over a serial line, explained as on a bus."""

from pathlib import Path

from firmware_bridge.explain.explainer import Explained
from firmware_bridge.families.epos2.maxon.frame import Frame, encode_v1, encode_v2
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    ObjectRead,
    ReadObject,
    Request,
    SendNmtService,
    WriteObject,
)
from firmware_bridge.families.epos2.maxon.opcodes import encode_answer, encode_request
from hil_tests.unit.explain.line_log import LineLog, kinds_of

STATUSWORD, CONTROLWORD, ERROR_CODE = 0x6041, 0x6040, 0x603F
TIMEOUT, NO_OBJECT = 0x0504_0000, 0x0602_0000


def command(log: LineLog, request: Request, answer: Done | ObjectRead | None) -> LineLog:
    body = None if answer is None else encode_v2(Frame(0, encode_answer(request, answer)))
    return log.exchanges(encode_v2(encode_request(request)), body or b"", cycle=10)


def read(log: LineLog, index: int, value: int, error: int = 0, node: int = 1) -> LineLog:
    return command(log, ReadObject(index, 0, node), ObjectRead(error, value.to_bytes(4, "little")))


def explained(log: LineLog, folder: Path) -> Explained:
    return log.explained(folder, "")


def regular(log: LineLog, statusword: int = 0x0737, times: int = 30) -> LineLog:
    for _ in range(times):
        read(log, STATUSWORD, statusword)
    return log


def test_drives_in_good_order_have_no_incident(tmp_path: Path) -> None:
    found = explained(regular(LineLog()), tmp_path)
    assert found.incidents == ()
    assert found.nodes == (1,)


def test_a_drive_that_goes_to_fault(tmp_path: Path) -> None:
    found = explained(regular(regular(LineLog()), 0x0708), tmp_path)
    assert kinds_of(found) == ["fault"]
    (one,) = found.incidents
    assert one.where == "node 1"
    assert one.evidence is not None
    assert "0x6041" in one.evidence.text


def test_an_error_code_in_an_answer_has_its_text(tmp_path: Path) -> None:
    log = read(regular(LineLog()), 0x1234, 0, NO_OBJECT)
    (one,) = explained(regular(log), tmp_path).incidents
    assert one.kind.name == "sdo_abort"
    assert "no such object" in one.what


def test_a_gateway_whose_node_does_not_answer(tmp_path: Path) -> None:
    log = read(regular(LineLog()), STATUSWORD, 0, TIMEOUT)
    (one,) = explained(regular(log), tmp_path).incidents
    assert one.kind.name == "sdo_timeout"


def test_a_network_command_for_an_enabled_drive(tmp_path: Path) -> None:
    log = command(regular(LineLog()), SendNmtService(1, 2), Done(0))
    assert "nmt_while_enabled" in kinds_of(explained(regular(log), tmp_path))


def test_a_written_object_is_followed(tmp_path: Path) -> None:
    log = regular(LineLog(), 0x0740)
    for _ in range(10):
        command(log, WriteObject(CONTROLWORD, 0, 1, (0x0F).to_bytes(4, "little")), Done(0))
        regular(log, 0x0740, 20)
    found = explained(log, tmp_path)
    assert kinds_of(found) == ["not_moving"]
    assert "0x000F" in found.incidents[0].what


def first_generation(log: LineLog, value: int) -> LineLog:
    """Read the statusword over V1: single bytes of handshake between the parts of frames."""
    request = encode_v1(encode_request(ReadObject(STATUSWORD, 0, 1)))
    answer = encode_v1(
        Frame(0, encode_answer(ReadObject(STATUSWORD, 0, 1), ObjectRead(0, bytes((value, 7, 0, 0)))))
    )
    log.sent(request[:1]).wait(1).received(b"O").wait(1).sent(request[1:]).wait(1).received(b"O" + answer[:1])
    return log.wait(1).sent(b"O").wait(1).received(answer[1:]).wait(1).sent(b"O").wait(5)


def test_the_older_protocol_is_read_as_well(tmp_path: Path) -> None:
    log = LineLog()
    for cycle in range(80):
        first_generation(log, 0x37 if cycle < 40 else 0x08)
    assert kinds_of(explained(log, tmp_path)) == ["fault"]


def test_a_device_that_refuses_a_frame(tmp_path: Path) -> None:
    log = LineLog()
    for _ in range(40):
        first_generation(log, 0x37)
    request = encode_v1(encode_request(ReadObject(STATUSWORD, 0, 1)))
    log.sent(request[:1]).wait(1).received(b"O").wait(1).sent(request[1:]).wait(1).received(b"F").wait(20)
    for _ in range(40):
        first_generation(log, 0x37)
    assert "line_refused" in kinds_of(explained(log, tmp_path))


def test_a_damaged_answer_is_garbage(tmp_path: Path) -> None:
    damaged = encode_v2(Frame(0, bytes(8)))[:-1] + b"\x00"
    log = regular(LineLog()).exchanges(encode_v2(encode_request(ReadObject(STATUSWORD, 0, 1))), damaged)
    assert "line_garbage" in kinds_of(explained(regular(log), tmp_path))
