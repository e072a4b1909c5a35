"""Transfers of the motor shield's library, and their effect."""

import pytest

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.jobs import Delay, OnBus
from emulators.arduino_omni.shield.motor_shield import PORTS
from emulators.arduino_omni.shield.tb6612 import COAST, BridgeDuty
from hil_tests.unit.arduino.master import ADDRESS, Master

BEGUN = [
    *("00 00", "00", "read 1", "00 10", "FE 03", "00 00", "pause 5000000", "00 A1"),
    *(f"{6 + 4 * n:02X} 00 00 00 00" for n in range(16)),
]


def shown(job: object) -> str:
    if isinstance(job, Delay):
        return f"pause {job.duration}"
    assert isinstance(job, OnBus)
    (segment,) = job.transfer.segments
    assert segment.address == ADDRESS
    return f"read {segment.to_read}" if segment.to_read else segment.written.hex(" ").upper()


def test_begin_writes_what_the_library_writes() -> None:
    assert [shown(job) for job in library.begin(ADDRESS)] == BEGUN


def test_begin_leaves_the_chip_at_1526_hz_and_all_motors_free() -> None:
    it = Master().begin()
    assert it.chip.register(0) == 0x21
    assert it.chip.period == 655_360  # 1525.88 Hz
    assert it.motors() == (COAST,) * 4


def test_begin_on_a_shield_that_runs_lets_it_run_again_before_it_ends() -> None:
    it = Master().begin()
    it.write("2E 00 10 00 00")
    it.write("26 00 00 00 08")
    seen = []
    for job in library.begin(ADDRESS):
        if isinstance(job, OnBus):
            it.do(job.transfer)
        elif isinstance(job, Delay):
            it.now += job.duration
        seen.append(it.motors()[0])
    assert seen[:3] == [BridgeDuty(cw=2048, brake=2048)] * 3
    assert seen[3:7] == [COAST] * 4
    assert seen[7] == BridgeDuty(cw=2048, brake=2048)  # RESTART
    assert seen[-1] == COAST


VECTORS = [
    (library.set_speed(PORTS[0], 128), "26 00 00 00 08"),
    (library.set_speed(PORTS[0], 255), "26 00 00 F0 0F"),
    (library.set_speed(PORTS[0], 1), "26 00 00 10 00"),
    (library.set_speed_fine(PORTS[0], 4095), "26 00 00 FF 0F"),
    (b" ".join(library.run(PORTS[0], 1)), "2A 00 00 00 00 20 2E 00 10 00 00"),
    (b" ".join(library.run(PORTS[0], 2)), "2E 00 00 00 00 20 2A 00 10 00 00"),
    (b" ".join(library.run(PORTS[0], 4)), "2E 00 00 00 00 20 2A 00 00 00 00"),
    (b" ".join(library.run(PORTS[0], 3)), ""),
    (b" ".join(library.run(PORTS[1], 1)), "36 00 00 00 00 20 32 00 10 00 00"),
    (b" ".join(library.run(PORTS[2], 1)), "12 00 00 00 00 20 16 00 10 00 00"),
    (b" ".join(library.run(PORTS[2], 2)), "16 00 00 00 00 20 12 00 10 00 00"),
    (b" ".join(library.run(PORTS[3], 1)), "1E 00 00 00 00 20 1A 00 10 00 00"),
]


@pytest.mark.parametrize(("made", "expected"), VECTORS)
def test_each_call_writes_what_the_library_writes(made: bytes, expected: str) -> None:
    assert made == bytes.fromhex(expected)


@pytest.mark.parametrize("number", [1, 2, 3, 4])
@pytest.mark.parametrize(
    ("command", "expected"),
    [
        (library.RunArgument.FORWARD, BridgeDuty(cw=4080, brake=16)),
        (library.RunArgument.BACKWARD, BridgeDuty(ccw=4080, brake=16)),
        (library.RunArgument.RELEASE, COAST),
    ],
)
def test_each_motor_gets_what_was_requested_it_and_no_other(
    number: int, command: library.RunArgument, expected: BridgeDuty
) -> None:
    it = Master().begin()
    port = library.motor(number)
    assert port is not None
    for job in library.drive(ADDRESS, port, 255, command):
        assert isinstance(job, OnBus)
        it.do(job.transfer)
    assert it.motors() == tuple(expected if n == number else COAST for n in range(1, 5))


@pytest.mark.parametrize("number", [0, 5, 255])
def test_there_are_four_motors(number: int) -> None:
    assert library.motor(number) is None
