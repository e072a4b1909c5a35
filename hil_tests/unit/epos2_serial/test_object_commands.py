"""Objects read and written by one serial command, on the drive itself and through it: what comes back."""

import pytest

from emulators.canopen.saved_parameters import SAVE
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.families.epos2.maxon.frame import Generation, MaxonAnswer
from firmware_bridge.families.epos2.maxon.messages import (
    Done,
    InitiateSegmentedRead,
    InitiateSegmentedWrite,
    ObjectRead,
    ReadObject,
    Request,
    SendNmtService,
    WriteObject,
)
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.epos2_serial.serial_desk import (
    FAR,
    NEAR,
    NO_NODE,
    SerialDesk,
    both,
    nodes,
    u32,
    with_profile,
)


@pytest.mark.opcode(0x10, 0x11)
@nodes
@both
def test_an_object_is_written_and_read_back(generation: Generation, node: int) -> None:
    desk = SerialDesk(generation)
    for index, value in ((0x6081, 2500), (0x607A, 0xFFFF_FFFE), (0x6060, 0xFD)):
        assert desk.requests(WriteObject(index, 0, node, u32(value))) == Done(0)
        assert desk.requests(ReadObject(index, 0, node)) == ObjectRead(0, u32(value))
    store = desk.far.store if node == FAR else desk.drive.store
    assert (store.get(od.MODE), store.get(od.TARGET_POSITION)) == (-3, -2)
    assert bool(desk.frames) is (node == FAR)


REFUSALS: tuple[tuple[str, Request, int], ...] = (
    ("no object", ReadObject(0x5555, 0, NEAR), 0x0602_0000),
    ("no sub-index", ReadObject(0x6040, 99, NEAR), 0x0609_0011),
    ("write-only", ReadObject(0x2025, 0, NEAR), 0x0601_0001),
    ("read-only", WriteObject(0x6041, 0, NEAR, u32(1)), 0x0601_0002),
    ("too high", WriteObject(0x2002, 0, NEAR, u32(6)), 0x0609_0031),
    ("too long to read at once", ReadObject(0x1008, 0, NEAR), 0x0607_0010),
    ("too short to write at once", WriteObject(0x20C1, 0, NEAR, u32(1)), 0x0607_0013),
    ("wrong password", WriteObject(0x1010, 1, NEAR, u32(SAVE + 1)), 0x0F00_FFBE),
    ("no object to begin with", InitiateSegmentedRead(0x5555, 0, NEAR), 0x0602_0000),
    ("nothing to write there", InitiateSegmentedWrite(0x1008, 0, NEAR, 5), 0x0601_0002),
    ("too much to write there", InitiateSegmentedWrite(0x6040, 0, NEAR, 3), 0x0607_0012),
)


@pytest.mark.parametrize("node", [NEAR, FAR], ids=["own", "gateway"])
@pytest.mark.parametrize(
    ("request_", "code"), [row[1:] for row in REFUSALS], ids=[row[0] for row in REFUSALS]
)
def test_a_refusal_is_the_same_on_the_line_and_through_the_gateway(
    request_: Request, code: int, node: int
) -> None:
    desk = SerialDesk(Generation.V1)
    assert isinstance(request_, ReadObject | WriteObject | InitiateSegmentedRead | InitiateSegmentedWrite)
    fields = {name: getattr(request_, name) for name in request_.__dataclass_fields__} | {"node": node}
    answer = desk.requests(type(request_)(**fields))
    assert answer is not None
    # An SDO server without the size takes what it has; only its own length check differs.
    reported = answer.error
    if node == FAR and code == 0x0607_0013:
        assert reported in {0x0607_0010, 0x0607_0012, 0x0607_0013}
    else:
        assert reported == code
    wanted = 8 if isinstance(request_, ReadObject) else 4
    assert isinstance(desk.host.outcome, MaxonAnswer)
    assert len(desk.host.outcome.body) == wanted
    assert not any(desk.host.outcome.body[4:])


@both
@pytest.mark.parametrize(
    ("node", "code"),
    [(NO_NODE, AbortCode.TIMEOUT), (128, AbortCode.WRONG_NODE), (255, AbortCode.WRONG_NODE)],
)
def test_a_node_that_does_not_answer(generation: Generation, node: int, code: int) -> None:
    desk = SerialDesk(generation)
    assert desk.requests(ReadObject(0x1000, 0, node)) == ObjectRead(code, bytes(4))
    waited = desk.host.ended_at - desk.host.begun_at
    assert (waited > 500 * MILLISECOND) is (code == AbortCode.TIMEOUT)
    assert desk.requests(ReadObject(0x1000, 0, FAR)) == ObjectRead(0, u32(0x0002_0192))


@both
def test_a_node_in_stopped_answers_nothing_but_the_line_still_does(generation: Generation) -> None:
    desk = SerialDesk(generation)
    desk.requests(SendNmtService(0, 2))
    assert (desk.drive.nmt_state, desk.far.nmt_state) == (NmtState.STOPPED, NmtState.STOPPED)
    assert desk.requests(ReadObject(0x1000, 0, FAR)) == ObjectRead(AbortCode.TIMEOUT, bytes(4))
    assert desk.requests(ReadObject(0x1000, 0, NEAR)) == ObjectRead(0, u32(0x0002_0192))


def test_bytes_beyond_the_object_s_size_are_the_profile_s() -> None:
    """Recorded: 10 62 behind a version of 16 bits; another device had 0x8090 there."""
    desk = SerialDesk(Generation.V1, with_profile(beyond_size=b"\x11\x22\x90\x80"))
    assert desk.requests(ReadObject(0x2003, 1, 0)) == ObjectRead(0, bytes.fromhex("26219080"))
    assert desk.requests(ReadObject(0x6061, 0, 0)) == ObjectRead(0, bytes.fromhex("01229080"))
    assert desk.requests(ReadObject(0x1000, 0, 0)) == ObjectRead(0, bytes.fromhex("92010200"))
    assert desk.requests(ReadObject(0x5555, 0, 0)) == ObjectRead(AbortCode.NO_OBJECT, bytes(4))
