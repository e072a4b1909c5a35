"""Homing that moves, with paper drives: the permission, the frames to the drive, the end, and the reports."""

import math
from collections.abc import Iterator
from typing import Final

import pytest

from firmware_bridge.bridge import Bridge
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import ControlwordBit, PowerState
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.robot import Axis
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.units import SECOND, Nanoseconds
from hil_tests.scenarios.homed import LIFT as FILE
from hil_tests.scenarios.homed import STEER as STEERS
from hil_tests.scenarios.homed import homed
from hil_tests.unit.bridge.bench import (
    ACCEPTED,
    DENIED,
    LIFT,
    STANDS,
    STEER,
    TEMPORARILY_REJECTED,
    Bench,
    Moments,
    sound,
)
from hil_tests.unit.bridge.fake_drive import ACTUAL_POSITION, FakeDrive

NAN: Final = float("nan")
ROBOT: Final = homed(FILE, STEERS)
FAILED: Final = 1 << 13

FRAMES: Final = (
    # 0x2081 := 0; 0x607C := 0.21 rad, 1671 qc; 0x6099:1 and :2 := 954 and 238 rpm; 0x609A := 9549 rpm/s;
    # 0x2080 := 500 mA; 0x6098 := -4, each read back; EPOS2 EDS for types.
    "23 81 20 00 00 00 00 00",
    "40 81 20 00 00 00 00 00",
    "23 7c 60 00 87 06 00 00",
    "40 7c 60 00 00 00 00 00",
    "23 99 60 01 ba 03 00 00",
    "40 99 60 01 00 00 00 00",
    "23 99 60 02 ee 00 00 00",
    "40 99 60 02 00 00 00 00",
    "23 9a 60 00 4d 25 00 00",
    "40 9a 60 00 00 00 00 00",
    "2b 80 20 00 f4 01 00 00",
    "40 80 20 00 00 00 00 00",
    "2f 98 60 00 fc 00 00 00",
    "40 98 60 00 00 00 00 00",
    # 0x6060 := 6, homing mode, until 0x6061 confirms it; 0x000F, 0x001F; the state is read once.
    "2f 60 60 00 06 00 00 00",
    "40 61 60 00 00 00 00 00",
    "2b 40 60 00 0f 00 00 00",
    "2b 40 60 00 1f 00 00 00",
    "40 41 60 00 00 00 00 00",
    # It has found it: read once more, halted, back to profile position, and the origin of its count.
    "40 41 60 00 00 00 00 00",
    "2b 40 60 00 0f 01 00 00",
    "2f 60 60 00 01 00 00 00",
    "40 61 60 00 00 00 00 00",
    "40 64 60 00 00 00 00 00",
)


class Seeking(FakeDrive):
    """Homes by any method: goes down with the speed of 0x6099:1 for some time, and is there."""

    def __init__(self, axis: Axis) -> None:
        super().__init__(axis)
        self.seeks_for: Nanoseconds = SECOND
        self.gives_up = False
        self.rushes = 1.0
        """Factor of its speed to the commanded one."""
        self.seeking = False
        self.error = False
        self._began_at: Nanoseconds | None = None

    def _obey(self, word: int) -> None:
        edge = word & ~self._word & ControlwordBit.NEW_SETPOINT
        starts = edge and self._homes and self.state is PowerState.OPERATION_ENABLED
        if starts and self.memory[od.HOMING_METHOD] != ACTUAL_POSITION:
            self.seeking, self.referenced, self.attained, self.error = True, False, False, False
            self._began_at, self._word = None, word
        elif not word & ControlwordBit.NEW_SETPOINT or word & ControlwordBit.HALT:
            self.seeking = False
        super()._obey(word)

    def _move(self, now: Nanoseconds) -> None:
        if self.seeking:
            self._began_at = now if self._began_at is None else self._began_at
            turns = int.from_bytes(self.memory[od.HOMING_SPEED_SWITCH], "little") / 60.0 * self.rushes
            elapsed = (now - self._moved_at) / SECOND
            self.position -= turns * elapsed * Epos2Axis.of(self.axis).counts_per_turn
            if now >= self._began_at + self.seeks_for:
                self._ends()
        super()._move(now)

    def _ends(self) -> None:
        self.seeking = False
        if self.gives_up:
            self.error = True
            return
        self.position = float(int.from_bytes(self.memory[at.HOME_POSITION], "little", signed=True))
        self.referenced = self.attained = True

    def _status(self) -> bytes:
        word = int.from_bytes(super()._status(), "little")
        return (word | (FAILED if self.error else 0)).to_bytes(2, "little")


@pytest.fixture
def bench() -> Iterator[Bench]:
    """Four drives that know their zero; a bridge that homes lift and steering; the guard refuses nothing."""
    yield from sound(begun(Bridge(ROBOT, ROBOT_TYPE)))


@pytest.fixture(scope="module")
def moments() -> Moments:
    return Moments(lambda: begun(Bridge(ROBOT, ROBOT_TYPE)))


def begun(bridge: Bridge) -> Bench:
    return Bench(ROBOT, bridge, {axis.name: Seeking(axis) for axis in ROBOT.axes})


def active(bench: Bench, name: str) -> bool:
    return name in {event.name for event in bench.bridge.interlock_events}


def words(bench: Bench, since: Nanoseconds) -> list[str]:
    return [word for _, word in bench.sent(0x604, since)]


def homing(bench: Bench) -> Seeking:
    """Begin to home the lift; return its drive, on its way."""
    assert bench.commands(STANDS, LIFT, NAN) == ACCEPTED
    bench.runs(0.4)
    assert active(bench, "homing: lift")
    drive = bench.drives["lift"]
    assert isinstance(drive, Seeking)
    assert drive.seeking
    return drive


def test_what_goes_to_the_drive_is_read_back_before_it_starts(started: Bench) -> None:
    begin = started.now
    assert started.commands(STANDS, LIFT, NAN) == ACCEPTED
    started.runs(2.0)
    assert tuple(words(started, begin)) == FRAMES
    for node in (1, 2, 3):
        assert [word for _, word in started.sent(0x600 + node, begin) if not word.startswith("40 7c")] == []


def test_it_is_lost_while_it_homes_known_when_it_has_and_drives(started: Bench) -> None:
    homing(started)
    assert active(started, "reference lost: lift")
    assert started.arms() == TEMPORARILY_REJECTED
    assert "arm: node 4 (scissor lift) is homing" in started.reported()
    started.runs(1.5)
    assert not active(started, "homing: lift")
    assert not active(started, "reference lost: lift")
    assert started.bridge.places["lift"] == 0.0
    assert started.arms() == ACCEPTED
    started.lift = 1.0
    started.runs(1.0)
    assert started.drives["lift"].position > 0.0


def test_one_at_a_time_and_none_is_confirmed_meanwhile(started: Bench) -> None:
    homing(started)
    for axis, value in ((STEER, NAN), (LIFT, NAN), (STEER, 0.0), (LIFT, 0.1)):
        assert started.commands(STANDS, axis, value) == TEMPORARILY_REJECTED
        title = "home" if math.isnan(value) else "zero"
        assert f"{title}: node 4 (scissor lift) is homing; wait" in started.reported()
    started.runs(1.5)
    assert not active(started, "reference lost: lift")


def test_an_axis_waits_for_those_that_its_file_names(bench: Bench) -> None:
    bench.drives["lift"].referenced = False
    bench.starts()
    assert bench.commands(STANDS, STEER, NAN) == TEMPORARILY_REJECTED
    assert "home: node 4 (scissor lift): its reference is lost" in bench.reported()
    assert bench.commands(STANDS, LIFT, 0.0) == ACCEPTED
    bench.runs(0.5)
    assert bench.commands(STANDS, STEER, NAN) == ACCEPTED


def test_who_is_not_named_keeps_no_one(bench: Bench) -> None:
    bench.drives["steer"].referenced = False
    bench.starts()
    assert bench.commands(STANDS, LIFT, NAN) == ACCEPTED


def test_a_homed_axis_may_be_confirmed_as_well(started: Bench) -> None:
    assert started.commands(STANDS, LIFT, 0.3) == ACCEPTED
    started.runs(0.3)
    assert started.bridge.places["lift"] == pytest.approx(0.3, abs=1e-4)
    assert started.commands(STANDS, 1, NAN) == DENIED, "a wheel has no place"


def test_it_needs_an_operator_who_speaks(started: Bench) -> None:
    started.talks = False
    started.runs(1.0)
    assert started.commands(STANDS, LIFT, NAN) == TEMPORARILY_REJECTED
    assert "home: no motion command for" in started.reported()


def test_no_one_homes_an_armed_robot(started: Bench) -> None:
    assert started.arms() == ACCEPTED
    assert started.commands(STANDS, LIFT, NAN) == DENIED
    assert "home: disarm first" in started.reported()


@pytest.mark.parametrize(
    ("command", "params"),
    [
        (dialect.MAV_CMD_COMPONENT_ARM_DISARM, (0.0,)),
        (dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, (0.0,)),
        (dialect.MAV_CMD_DO_PAUSE_CONTINUE, (0.0,)),
        (dialect.MAV_CMD_DO_SET_MODE, (1.0, 4.0)),
    ],
    ids=["disarm", "emergency stop", "pause", "hold"],
)
def test_every_way_to_ask_for_a_stop_stops_it(
    started: Bench, command: int, params: tuple[float, ...]
) -> None:
    drive = homing(started)
    assert started.commands(command, *params) == ACCEPTED
    started.runs(0.1)
    assert not drive.seeking
    assert active(started, "not homed: lift")
    assert active(started, "reference lost: lift")
    assert "it was stopped by an order" in started.reported()
    stood = drive.position
    started.runs(2.0)
    assert drive.position == pytest.approx(stood, abs=1)


def test_one_that_was_stopped_is_set_up_again_and_homed_by_the_next_order(started: Bench) -> None:
    drive = homing(started)
    started.commands(dialect.MAV_CMD_COMPONENT_ARM_DISARM, 0.0)
    started.runs(0.3)
    assert started.commands(STANDS, LIFT, NAN) == TEMPORARILY_REJECTED
    assert "home: enabling node 4 (scissor lift)" in started.reported()
    started.runs(1.0)
    assert drive.memory[od.MODE] == b"\x01"
    assert started.commands(STANDS, LIFT, NAN) == ACCEPTED
    started.runs(0.1)
    assert not active(started, "not homed: lift")
    started.runs(2.0)
    assert started.arms() == ACCEPTED


def test_a_drive_that_fails_is_reported_and_halted(started: Bench) -> None:
    started.drives["lift"].gives_up = True
    homing(started)
    begin = started.now
    started.runs(1.5)
    assert "was not homed: it gave its homing up" in started.reported()
    assert "2b 40 60 00 0f 01 00 00" in words(started, begin)
    assert active(started, "reference lost: lift")


def test_one_that_does_not_end_is_halted_in_its_time(started: Bench) -> None:
    """It creeps; the file gives it 12 s. Afterwards no one moves it."""
    started.stands()
    drive = started.drives["steer"]
    drive.seeks_for, drive.rushes = 1000 * SECOND, 0.1
    begin = started.now
    assert started.commands(STANDS, STEER, NAN) == ACCEPTED
    started.runs(11.5)
    assert drive.seeking
    started.runs(1.0)
    assert not drive.seeking
    assert started.now - begin < 13 * SECOND
    assert "was not homed: it has not found its zero in time" in started.reported()
    assert active(started, "reference lost: steer")


def test_one_that_goes_beyond_its_travel_is_stopped(started: Bench) -> None:
    """From end to end are 5.33 rad, 0.15 of offset, and 0.23 beyond: at 1 rad/s it is stopped before 6 s."""
    started.stands()
    drive = started.drives["steer"]
    drive.seeks_for = 1000 * SECOND
    assert started.commands(STANDS, STEER, NAN) == ACCEPTED
    started.runs(5.5)
    assert drive.seeking
    started.runs(0.7)
    assert not drive.seeking
    assert "it went further than 5.713 rad" in started.reported()
    assert active(started, "reference lost: steer")


def test_one_that_runs_faster_loses_its_power(started: Bench) -> None:
    drive = homing(started)
    drive.rushes, drive.seeks_for = 1.5, 100 * SECOND
    started.runs(0.8)
    assert not drive.seeking
    assert drive.state is not PowerState.OPERATION_ENABLED
    assert "homing, moves with -5.99 rad/s" in started.reported()
    assert active(started, "not homed: lift")


@pytest.mark.parametrize(
    ("address", "lies"),
    [
        (od.HOMING_METHOD, b"\xfd"),
        (od.HOMING_SPEED_SWITCH, (9999).to_bytes(4, "little")),
        (od.HOME_OFFSET, bytes(4)),
        (at.HOMING_CURRENT, bytes(2)),
        (od.MODE, b"\x01"),
    ],
)
def test_a_drive_that_reads_back_something_else_is_never_started(
    started: Bench, address: Address, lies: bytes
) -> None:
    drive = started.drives["lift"]

    class Liar(dict[Address, bytes]):
        def __setitem__(self, key: Address, value: bytes) -> None:
            super().__setitem__(key, lies if key == address else value)

    drive.memory = Liar(drive.memory)
    begin = started.now
    assert started.commands(STANDS, LIFT, NAN) == ACCEPTED
    started.runs(1.0)
    assert [word for word in words(started, begin) if word.startswith("2b 40 60 00 1f")] == []
    assert active(started, "not homed: lift")
    assert active(started, "reference lost: lift")
    assert started.arms() == TEMPORARILY_REJECTED


def test_at_the_start_one_is_homed_after_the_other() -> None:
    bench = begun(Bridge(ROBOT, ROBOT_TYPE, confirmed=(ConfirmPosition("lift"), ConfirmPosition("steer"))))
    for name in ("lift", "steer"):
        bench.drives[name].referenced = False
        bench.drives[name].seeks_for = 2 * SECOND
    bench.runs(2.0)
    assert active(bench, "homing: lift")
    bench.runs(2.0)
    assert not active(bench, "reference lost: lift")
    assert active(bench, "homing: steer")
    bench.runs(2.5)
    assert bench.arms() == ACCEPTED
    assert bench.guard.refused == 0


def test_at_the_start_no_one_homes_without_an_operator() -> None:
    bench = begun(Bridge(ROBOT, ROBOT_TYPE, confirmed=(ConfirmPosition("lift"),)))
    bench.drives["lift"].referenced = False
    bench.talks = False
    bench.runs(8.0)
    bench.talks = True
    bench.runs(3.0)
    assert active(bench, "reference lost: lift")
    assert bench.sent(0x604) != []
    assert [word for word in words(bench, 0) if word.startswith("2f 98 60")] == []
