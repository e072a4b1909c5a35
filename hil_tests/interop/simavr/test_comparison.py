"""The sketch as it is flashed, run by simavr, against the emulator: the same bytes on serial and on I2C.

They are run by `pytest -m avr`, a step of `make nightly`, and fail there where gcc-avr, the core or libsimavr
is missing; no other run of the tests has them. `make compare-sketch` runs as many lines as it is given.
"""

from collections.abc import Iterator
from pathlib import Path

import pytest

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.jobs import OnBus
from emulators.arduino_omni.shield.motor_shield import PORTS
from hil_tests.interop.simavr.comparison import (
    AUTO_STOP,
    Binary,
    Bytes,
    Edges,
    Emulated,
    Event,
    Level,
    Received,
    Time,
    built,
    differences,
)
from hil_tests.interop.simavr.lines import happening

pytestmark = pytest.mark.avr
LINES = 2_000


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    return built(tmp_path_factory.mktemp("sketch"))


def on_bus(*writes: bytes) -> str:
    return "".join(f"60w{data.hex().upper()}," for data in writes)


def drive(*speeds: int) -> str:
    writes = []
    for port, speed in zip(PORTS, speeds, strict=False):
        run = (
            library.RunArgument.RELEASE
            if speed == 0
            else library.RunArgument.BACKWARD
            if speed < 0
            else library.RunArgument.FORWARD
        )
        writes += [library.set_speed(port, abs(speed)), *library.run(port, run)]
    return on_bus(*writes)


STILL = drive(0, 0, 0)
OK = b"OK\r\n"
# (1000 - 0) x 20 / 50 is more than there is; counts of a frame of 12, 3 and 0.
STORY: list[tuple[Event, bytes, str]] = [
    (Bytes(b"m 1000 -5 0\r"), OK, ""),
    (Time(33), b"", ""),
    (Time(34), b"", drive(255, -2, 0)),
    (Edges(1, -12), b"", ""),
    (Edges(2, 3), b"", ""),
    (Time(67), b"", drive(255, 3, -1)),
    (Bytes(b"e\r"), b"0 -12 3\r\n", ""),
    (Bytes(b"m 0 0 0\r"), OK, STILL),
    (Time(100), b"", ""),
    (Edges(0, 400), b"", ""),  # pushed
    (Bytes(b"m 10 0 0\r"), OK, ""),
    (Time(133), b"", drive(4, 0, 0)),
    (Edges(0, -400), b"", ""),
    (Bytes(b"o 255 -300 0\r"), OK, drive(255, -255, 0)),
    (Time(133 + AUTO_STOP), b"", ""),
    (Time(134 + AUTO_STOP), b"", STILL),
    (Time(135 + AUTO_STOP), b"", ""),
    (Bytes(b"o -32768 32768 65537\r"), OK, drive(-255, -255, 1)),
    (Bytes(b"u 1:0:0:0\r"), OK, ""),
    (Bytes(b"m 7 -7 0\r"), OK, ""),
    (Time(166 + AUTO_STOP), b"", drive(-1, 1, -1)),  # divided by zero
    (Bytes(b"w 2 1\rc 3 1\rc 21 1\r"), 3 * OK, ""),  # not the sketch's own pins
    (Bytes(b"e\rd 2\rd 20\rd 99\r"), b"0 -12 3\r\n0\r\n1\r\n0\r\n", ""),
    (Level(30, high=True), b"", ""),
    (Bytes(b"d 30\rc 30 1\rd 30\r"), b"1\r\nOK\r\n0\r\n", ""),
    (Bytes(b"p 40\r" + 50 * b"b\r"), b"0\r\n" + 31 * b"57600\r\n", ""),  # 63 bytes are kept
    (Bytes(b"\r"), b"57600\r\n", ""),
]


def test_the_sketch_releases_the_motors_before_it_sets_the_shield_up(made: tuple[Path, Path]) -> None:
    with Binary(*made) as binary:
        assert binary.at_start == Emulated().at_start
        jobs = [it.transfer for it in library.begin(0x60) if isinstance(it, OnBus)]
        writes = [it.segments[0].written for it in jobs]
        assert writes[2] == b""
        wanted = on_bus(b"\xfd\x10", *writes[:2]) + "60r00," + on_bus(*writes[3:])
        assert binary.at_start == Received(b"", wanted)


def test_a_story_with_what_it_must_be(made: tuple[Path, Path]) -> None:
    emulated = Emulated()
    with Binary(*made) as binary:
        for event, serial, bus in STORY:
            wanted = Received(serial, bus)
            assert (event, binary.happens(event)) == (event, wanted)
            assert (event, emulated.happens(event)) == (event, wanted)


@pytest.mark.parametrize("seed", range(4))
def test_lines_at_random(made: tuple[Path, Path], seed: int) -> None:
    with Binary(*made) as binary:
        assert list(differences(binary, Emulated(), happening(seed, LINES // 4))) == []


def test_a_sketch_that_stops_a_millisecond_later_is_found(tmp_path: Path) -> None:
    def quiet() -> Iterator[Event]:
        yield Bytes(b"o 9 9 9\r")
        yield Time(AUTO_STOP + 1)

    with Binary(*built(tmp_path, AUTO_STOP + 1)) as binary:
        (found,) = differences(binary, Emulated(), quiet())
    assert "Time(millis=501)" in found
