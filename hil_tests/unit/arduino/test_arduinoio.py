"""ArduinoIO, both ends: the worked commands whole and byte by byte, what does not fit, 16-bit counters."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from emulators.arduino_omni.shield.tb6612 import COAST, BridgeDuty
from emulators.arduino_omni.sketches.arduinoio import ArduinoIoSketch
from firmware_bridge.families.motor_shield.wire import arduinoio as io
from firmware_bridge.node import DTR_UP
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.lanes import examples
from hil_tests.unit.arduino.hosts import Host


def host() -> Host:
    it = Host(ArduinoIoSketch, io.BAUD)
    it.mega.pins.analog[0] = 512
    it.ask(bytes.fromhex("45 30 63 64"))
    it.mega.shafts.edges[0] = 1234
    return it


EXCHANGES = [
    ("A", (1, 200), "41 31 C8", ""),
    ("B", (1, ord("f")), "42 31 66", ""),
    ("B", (1, ord("r")), "42 31 72", ""),
    ("E", (0, 2, 3), "45 30 63 64", ""),
    ("G", (0,), "47 30", "31 32 33 34 0D 0A"),
    ("9", (9,), "39 39", "34 0D 0A"),
    ("3", (0,), "33 61", "35 31 32 0D 0A"),
    ("0", (13, 1), "30 6E 31", ""),
    ("2", (13, 1), "32 6E 31", ""),
    ("X", (200,), "58 C8", "32 30 30 0D 0A"),
]


@pytest.mark.parametrize("slowly", [False, True])
@pytest.mark.parametrize(("letter", "values", "requested", "answered"), EXCHANGES)
def test_both_ends_say_and_read_the_worked_bytes(
    letter: str, values: tuple[int, ...], requested: str, answered: str, *, slowly: bool
) -> None:
    assert io.encode(letter, *values) == bytes.fromhex(requested)
    it = host()
    stated = (it.ask_slowly if slowly else it.ask)(bytes.fromhex(requested))
    assert stated == bytes.fromhex(answered)
    assert (io.decode(stated.removesuffix(b"\r\n")) is not None) is io.COMMANDS[letter].answers


def test_what_is_written_to_the_shield_and_what_the_motors_get() -> None:
    it = host()
    it.spy.transfers.clear()
    it.ask(io.encode("A", 1, 200) + io.encode("B", 1, ord("f")))
    assert it.spy.transfers == ["26 00 00 80 0C", "2A 00 00 00 00", "2E 00 10 00 00"]
    it.ask(io.encode("A", 3, 255) + io.encode("B", 3, ord("b")))
    assert it.motors() == (BridgeDuty(cw=3200, brake=896), COAST, BridgeDuty(ccw=4080, brake=16), COAST)
    it.ask(io.encode("B", 1, ord("x")))
    assert it.motors()[0] == BridgeDuty(cw=3200, brake=896)
    it.run(3600 * SECOND)
    assert it.motors()[0] == BridgeDuty(cw=3200, brake=896)  # nothing stops by itself
    it.ask(io.encode("B", 1, ord("r")))
    assert it.motors()[0] == COAST


def test_a_reset_of_the_board_ends_in_a_stand_when_setup_has_run() -> None:
    it = host()
    it.ask(io.encode("A", 1, 200) + io.encode("B", 1, ord("f")))
    it.send(b"", DTR_UP)
    it.run(1100 * MILLISECOND)
    assert it.motors()[0] == BridgeDuty(cw=3200, brake=896)
    it.run(20 * MILLISECOND)
    assert it.motors()[0] == COAST


def number(it: Host, letter: str, *values: int) -> int:
    stated = io.decode(it.ask(io.encode(letter, *values)).removesuffix(b"\r\n"))
    assert stated is not None
    return stated


def test_counters_have_16_bits_and_wrap() -> None:
    it = host()
    it.mega.shafts.edges[0] = 32_768
    assert number(it, "G", 0) == -32_768
    it.ask(io.encode("H", 0))
    it.mega.shafts.edges[0] += 5
    assert number(it, "G", 0) == 5
    it.ask(io.encode("F", 0))
    it.mega.shafts.edges[0] += 5
    assert number(it, "G", 0) == 5
    assert number(it, "G", 2) == 0
    it.ask(io.encode("H", 0))
    assert number(it, "G", 0) == 0


def test_the_third_motor_has_no_interrupts_left() -> None:
    it = host()
    for encoder, pins in ((1, (19, 18)), (2, (10, 11))):
        it.ask(io.encode("E", encoder, *pins))
    it.mega.shafts.edges[1:] = [7, 7]
    assert [number(it, "G", encoder) for encoder in (1, 2)] == [-7, 0]


def test_servos_and_pins() -> None:
    it = host()
    it.mega.pins.driven[7] = True
    assert [number(it, "1", 7), number(it, "5", 9), number(it, "7", 9)] == [1, 0, 90]
    it.ask(io.encode("6", 9, 1) + io.encode("8", 9, 200))
    assert [number(it, "5", 9), number(it, "7", 9)] == [1, 180]
    it.ask(io.encode("6", 9, 0))
    assert number(it, "5", 9) == 0
    it.ask(io.encode("4", 11, 77))
    assert it.mega.pins.duties == {11: 77}


@pytest.mark.parametrize(
    "wrong",
    [b"/", b"Z", b"\xff", b"98", b"A0", b"A5", b"0b", b"0\xa7", b"0n2", b"3q", b"G3", b"E0cb", b"S", b"D1r"],
)
def test_what_does_not_fit_ends_the_command_in_silence_and_is_used_up(wrong: bytes) -> None:
    it = host()
    assert it.ask(wrong + b"99") == b"4\r\n"


def test_half_a_command_waits_for_ever() -> None:
    it = host()
    assert it.ask(b"9", 3600 * SECOND) == b""
    assert it.ask(b"9") == b"4\r\n"


@given(
    st.sampled_from(io.ROWS).flatmap(
        lambda row: st.tuples(st.just(row), *(st.integers(k.first, k.last) for k in row.follows))
    )
)
def test_a_board_takes_what_the_hosts_end_makes(case: tuple[io.ArduinoIoCommand, ...]) -> None:
    row, *values = case
    made = io.encode(row.letter, *values)  # type: ignore[arg-type]
    assert len(made) == 1 + len(row.follows)
    assert all(kind.takes(byte) for kind, byte in zip(row.follows, made[1:], strict=True))


@pytest.mark.parametrize(
    ("letter", "values", "why"),
    [
        ("Q", (), "no command"),
        ("A", (5, 1), "motor must be from 1 to 4, and is 5"),
        ("A", (1,), "takes 2 values, and got 1"),
    ],
)
def test_the_hosts_end_refuses_what_the_sketch_would_not_take(
    letter: str, values: tuple[int, ...], why: str
) -> None:
    with pytest.raises(ValueError, match=why):
        io.encode(letter, *values)


@settings(max_examples=examples(60))
@given(st.lists(st.binary(max_size=40), max_size=8))
def test_whatever_a_foreign_node_sends_silence_or_numbers(chunks: list[bytes]) -> None:
    it = host()
    stated = b"".join(it.ask(chunk) for chunk in chunks)
    assert all(io.decode(line) is not None for line in stated.split(b"\r\n")[:-1])
    assert stated == b"" or stated.endswith(b"\r\n")
    it.ask(bytes(4))  # ends whatever was begun
    assert it.ask(b"99") == b"4\r\n"


@given(st.binary(max_size=20))
def test_whatever_a_board_states_the_hosts_end_reads_a_number_or_none(noise: bytes) -> None:
    io.decode(noise)
