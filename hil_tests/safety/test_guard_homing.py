"""Steps of a moving homing that the guard lets pass: within the file's values, and one axis at a time."""

from collections.abc import Callable
from typing import Final, TypeAlias

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.driver.product import by_homing
from firmware_bridge.families.epos2.guard.product import by_file
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import parse
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.safety import guard_bench, serial_bench
from hil_tests.safety.guard_bench import raw
from hil_tests.safety.test_guard_zero import (
    ENABLE,
    ENABLED,
    HALT,
    LEFT,
    LIFT,
    NEW_POSITION,
    SIZES,
    START,
    STEER,
)
from hil_tests.safety.test_guard_zero import OverCan as ZeroOverCan
from hil_tests.safety.test_guard_zero import OverSerial as ZeroOverSerial
from hil_tests.scenarios.homed import LIFT as FILE
from hil_tests.scenarios.homed import STEER as STEERS
from hil_tests.scenarios.homed import TEXT, homed, text_of

SIZE: Final = {
    **SIZES,
    od.HOME_OFFSET: 4,
    od.HOMING_SPEED_SWITCH: 4,
    od.HOMING_SPEED_ZERO: 4,
    od.HOMING_ACCELERATION: 4,
    at.HOMING_CURRENT: 2,
}
ROBOT: Final = homed(FILE, STEERS)
PLACED: Final = homed(FILE.replace("offset", "at = 100.0\noffset"), STEERS)
OFFSET_QC: Final = 1671
"""0.21 rad of the screw, times 25 in the gear, times 2000 quadcounts a turn."""
FAST, SLOW, RAMP, CURRENT = 954, 238, 9549, 500
"""4 and 1 rad/s, and 40 rad/s2, of the screw in rpm of the motor: times 25, times 60 over 2 pi; mA."""


class OverCan(ZeroOverCan):
    def __init__(self, robot: AnyRobot = ROBOT) -> None:
        super().__init__()
        self.bench = guard_bench.Bench(robot)
        self.far = False
        """True if the lift is on a link of its own."""

    def _states(self, packet: Packet) -> str | None:
        """Let it leave on the link of its node."""
        return super()._states(Packet(self._link_of(packet.address), packet.address, packet.payload))

    def _link_of(self, address: int) -> str:
        return "far" if self.far and address % 0x80 == LIFT else guard_bench.LINK

    def writes(self, node: int, address: Address, value: int) -> str | None:
        write = guard_bench.write(node, address.index, address.subindex, raw(value, SIZE[address]))
        return self._states(write)

    def reports(self, node: int, address: Address, value: int) -> None:
        size = SIZE[address]
        head = bytes((0x43 | (4 - size) << 2,)) + address.index.to_bytes(2, "little")
        payload = head + bytes((address.subindex,)) + raw(value, size).ljust(4, b"\0")
        self.bench.receives(Packet(self._link_of(node), 0x580 + node, payload), now=self.now)

    def goes(self, node: int, target: int) -> str | None:
        return self._states(guard_bench.position(node, NEW_POSITION, target))

    def rests(self, cycles: int) -> None:
        """Let every axis but the lift be commanded to rest for so many cycles."""
        for _ in range(cycles):
            self.now += 50 * MILLISECOND
            wheels = (guard_bench.wheel(node, ENABLE, 0) for node in (LEFT, 2))
            self.bench.states(*wheels, guard_bench.position(STEER, HALT, 0), now=self.now)


class OverSerial(ZeroOverSerial):
    def __init__(self, robot: AnyRobot = ROBOT) -> None:
        super().__init__()
        self.bench = serial_bench.SerialBench(serial_bench._over_serial(robot))  # noqa: SLF001 - of a test's own bench

    def writes(self, node: int, address: Address, value: int) -> str | None:
        return self._states(serial_bench.writing(node, address, raw(value, SIZE[address])))

    def reports(self, node: int, address: Address, value: int) -> None:
        requested = serial_bench.reading(node, address)
        self.bench.states(requested, now=self.now)
        self.bench.receives(serial_bench.value(requested, raw(value, SIZE[address])), now=self.now)

    def goes(self, node: int, target: int) -> str | None:
        self._states(serial_bench.target(node, target))
        return self._states(serial_bench.word(node, NEW_POSITION))

    def rests(self, cycles: int) -> None:
        for _ in range(cycles):
            self.now += 50 * MILLISECOND
            for node in (LEFT, 2):
                self._states(serial_bench.speed(0, node))
                self._states(serial_bench.word(node, ENABLE))
            self._states(serial_bench.word(STEER, HALT))


Line: TypeAlias = OverCan | OverSerial
Made: TypeAlias = Callable[[], Line]
BOTH: Final = pytest.mark.parametrize("made", [OverCan, OverSerial], ids=["can", "serial"])
VALUES: Final = {
    at.HOME_POSITION: 0,
    od.HOME_OFFSET: OFFSET_QC,
    od.HOMING_SPEED_SWITCH: FAST,
    od.HOMING_SPEED_ZERO: SLOW,
    od.HOMING_ACCELERATION: RAMP,
    at.HOMING_CURRENT: CURRENT,
    od.HOMING_METHOD: -4,
}
"""All at their bounds."""
NO_WORD: Final = "the drive has not reported that its homing moves no more than the file allows"


def prepared(
    line: Line, *, reports: dict[Address, int] | None = None, without: Address | None = None
) -> Line:
    """Write what the homing of the lift hangs on; let its drive say the same, but what the test changes."""
    line.reports(LIFT, od.STATUSWORD, ENABLED)
    line.position(HALT, 0)
    for address, value in VALUES.items():
        assert line.writes(LIFT, address, value) is None
        if address != without:
            line.reports(LIFT, address, (reports or {}).get(address, value))
    assert line.writes(LIFT, od.MODE, 6) is None
    line.reports(LIFT, od.MODE_DISPLAY, 6)
    assert line.writes(LIFT, od.CONTROLWORD, ENABLE) is None
    return line


def started(made: Made) -> Line:
    line = prepared(made())
    assert line.writes(LIFT, od.CONTROLWORD, START) is None
    return line


@BOTH
def test_the_whole_of_it_passes(made: Made) -> None:
    line = started(made)
    assert line.writes(LIFT, od.CONTROLWORD, HALT) is None
    assert line.writes(LIFT, od.MODE, 1) is None
    line.reports(LIFT, od.MODE_DISPLAY, 1)
    assert line.position(NEW_POSITION, 12_345) is None
    line.position(HALT, 0)


@BOTH
@pytest.mark.parametrize("without", VALUES)
def test_the_start_needs_each_word_of_the_drives(made: Made, without: Address) -> None:
    assert prepared(made(), without=without).writes(LIFT, od.CONTROLWORD, START) == NO_WORD


@BOTH
@pytest.mark.parametrize(
    ("address", "value"),
    [
        (at.HOME_POSITION, 1),
        (at.HOME_POSITION, -1),
        (od.HOME_OFFSET, OFFSET_QC + 1),
        (od.HOME_OFFSET, -OFFSET_QC),
        (od.HOMING_SPEED_SWITCH, FAST + 1),
        (od.HOMING_SPEED_SWITCH, 0),
        (od.HOMING_SPEED_ZERO, SLOW + 1),
        (od.HOMING_ACCELERATION, RAMP + 1),
        (at.HOMING_CURRENT, CURRENT + 1),
        (od.HOMING_METHOD, -3),
        (od.HOMING_METHOD, 17),
        (od.HOMING_METHOD, 0),
    ],
)
def test_a_drive_that_states_anything_else_is_not_started(made: Made, address: Address, value: int) -> None:
    assert prepared(made(), reports={address: value}).writes(LIFT, od.CONTROLWORD, START) == NO_WORD


@BOTH
@pytest.mark.parametrize(
    ("address", "value"),
    [(od.HOMING_SPEED_SWITCH, 1), (od.HOMING_ACCELERATION, RAMP - 1), (at.HOMING_CURRENT, 1)],
)
def test_slower_and_weaker_is_as_good(made: Made, address: Address, value: int) -> None:
    assert prepared(made(), reports={address: value}).writes(LIFT, od.CONTROLWORD, START) is None


@BOTH
@pytest.mark.parametrize(
    ("address", "value"),
    [
        (od.HOMING_METHOD, -3),
        (od.HOMING_METHOD, 33),
        (od.HOMING_SPEED_SWITCH, FAST + 1),
        (od.HOMING_SPEED_ZERO, SLOW + 1),
        (od.HOMING_ACCELERATION, RAMP + 1),
        (at.HOMING_CURRENT, CURRENT + 1),
        (od.HOME_OFFSET, OFFSET_QC - 1),
        (od.HOMING_SPEED_SWITCH, 0),
    ],
)
def test_nothing_beyond_the_file_is_written(made: Made, address: Address, value: int) -> None:
    assert made().writes(LIFT, address, value) is not None


@BOTH
@pytest.mark.parametrize("address", [address for address in VALUES if address not in SIZES])
def test_a_wheel_has_none_of_these(made: Made, address: Address) -> None:
    assert made().writes(LEFT, address, 1) == f"{address} is not an object that may be written"


@BOTH
def test_to_confirm_is_as_good_as_ever(made: Made) -> None:
    line = made()
    line.reports(LIFT, od.STATUSWORD, ENABLED)
    line.position(HALT, 0)
    for address, value in ((at.HOME_POSITION, 12_345), (od.HOMING_METHOD, 35), (od.MODE, 6)):
        assert line.writes(LIFT, address, value) is None
        line.reports(LIFT, od.MODE_DISPLAY if address == od.MODE else address, value)
    assert line.writes(LIFT, od.CONTROLWORD, START) is None
    assert line.goes(STEER, 20_000) is None, "it moves nothing, and keeps no one"


@BOTH
def test_a_place_elsewhere_belongs_to_its_file(made: Made) -> None:
    """Check the home position: by the file's method it must be the file's; by 35 any within travel."""
    kind = type(made())
    line = prepared(kind(PLACED))
    assert line.writes(LIFT, od.CONTROLWORD, START) == NO_WORD


@BOTH
def test_while_it_homes_nothing_else_is_commanded_to_move(made: Made) -> None:
    line = started(made)
    reason = line.goes(STEER, 20_000)
    assert reason == "homing: steering may not move while scissor lift is homing"
    with pytest.raises(AssertionError):
        line.wheel(100)


@BOTH
def test_it_is_not_started_while_something_moves(made: Made) -> None:
    line = prepared(made())
    assert line.goes(STEER, 20_000) is None
    refused = line.writes(LIFT, od.CONTROLWORD, START)
    assert refused == "a homing started while node 3 may move"


@BOTH
def test_it_is_not_started_twice(made: Made) -> None:
    refused = started(made).writes(LIFT, od.CONTROLWORD, START)
    assert refused == "a homing started while node 4 may move"


@BOTH
@pytest.mark.parametrize("address", [*VALUES, od.MODE])
def test_nothing_that_it_hangs_on_is_written_meanwhile(made: Made, address: Address) -> None:
    assert started(made).writes(LIFT, address, VALUES.get(address, 1)) is not None


@BOTH
def test_no_new_position_while_it_homes(made: Made) -> None:
    assert started(made).position(NEW_POSITION, 0) == "a new position in homing mode"


@BOTH
@pytest.mark.parametrize("word", [ENABLE, HALT, 0x000B, 0x0000])
def test_every_stop_passes_while_it_homes(made: Made, word: int) -> None:
    line = started(made)
    assert line.position(word, 0) is None
    line.wheel(100)


@BOTH
def test_a_silence_about_its_own_axis_is_no_silence(made: Made) -> None:
    line = started(made)
    line.rests(60)
    assert line.bench.guard.refused == 0


@BOTH
def test_a_bridge_that_sends_nothing_is_spoken_for(made: Made) -> None:
    line = started(made)
    line.now += SECOND
    sent = line.bench.states(now=line.now)
    assert sent
    assert line.bench.refusals[-1].reason.startswith("no set-point for 150 ms")


@BOTH
def test_a_homing_that_stands_too_long_is_stopped(made: Made) -> None:
    """13 s in the file, and one more in which the bridge should have halted it."""
    kind = type(made())
    quick = homed(FILE.replace("speed = 4.0", "speed = 29.0").replace("within_s = 100.0", "within_s = 13.0"))
    line = started(lambda: kind(quick))
    ends = line.now + 14 * SECOND
    while line.now < ends - 100 * MILLISECOND:
        line.rests(1)
    assert line.bench.guard.refused == 0
    line.rests(3)
    assert line.bench.refusals[-1].reason == "homing stayed beyond its bound"
    assert line.goes(STEER, 20_000) is None, "the halt has ended it"


def test_another_link_counts_as_well() -> None:
    """The lift on a bus of its own: it is not started while steering moves, nor the other way round."""
    link = TEXT[TEXT.index("[links.drives]") : TEXT.index("[geometry.base]")]
    head, lift = text_of(FILE).split('title = "scissor lift"')
    two = head.replace(link, link + link.replace("drives", "far", 1)) + 'title = "scissor lift"'
    robot = parse(two + lift.replace('link = "drives"', 'link = "far"', 1), "far.toml")
    line = OverCan(robot)
    line.far = True
    prepared(line)
    assert line.goes(STEER, 20_000) is None
    assert line.writes(LIFT, od.CONTROLWORD, START) == "a homing started while node 3 may move"
    line.rests(1)
    assert line.writes(LIFT, od.CONTROLWORD, START) is None
    assert line.goes(STEER, 20_000) == "homing: steering may not move while scissor lift is homing"


REPORTED: Final = st.fixed_dictionaries(
    {
        "speed": st.floats(0.11, 29.0),
        "zero_speed": st.floats(0.11, 29.0),
        "acceleration": st.floats(0.11, 1e4),
        "offset": st.floats(-300.0, 300.0),
        "at": st.floats(0.0, 363.0),
    }
)


@given(direction=st.sampled_from((-1, 1)), ratio=st.floats(1.0, 500.0), reported=REPORTED)
def test_what_the_driver_writes_is_what_the_guard_lets_pass(
    direction: int, ratio: float, reported: dict[str, float]
) -> None:
    """They convert apart from each other, for any gear and either direction."""
    of_file = ROBOT.axes[3]
    homing = of_file.zero.homing
    assert homing is not None
    zero = of_file.zero.model_copy(update={"homing": homing.model_copy(update=reported)})
    axis = of_file.model_copy(update={"zero": zero, "direction": direction, "ratio": ratio})
    allowed = by_file(axis)
    rows = by_homing(axis)
    assert {row.address for row in rows} == set(allowed)
    for row in rows:
        assert row.value in allowed[row.address], row.expected
