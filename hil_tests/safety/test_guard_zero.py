"""Steps of a homing by method 35 that the guard lets pass: in their order, by the drive's own report."""

from collections.abc import Callable
from typing import Final, Protocol, TypeAlias

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.families.epos2.maxon.messages import SendNmtService
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.safety import guard_bench, serial_bench

LEFT, STEER, LIFT = 1, 3, 4
LIFT_TOP: Final = 2_890_879
SIZES: Final = {
    at.HOME_POSITION: 4,
    od.HOMING_METHOD: 1,
    od.MODE: 1,
    od.MODE_DISPLAY: 1,
    od.CONTROLWORD: 2,
    od.STATUSWORD: 2,
}
ENABLE, HALT, START, NEW_POSITION = 0x000F, 0x010F, 0x001F, 0x003F
ENABLED: Final = 0x0737


class Line(Protocol):
    """One way to the drives of RARS, with the guard on it."""

    def writes(self, node: int, address: Address, value: int) -> str | None:
        """Let the bridge write; return why it was refused."""

    def reports(self, node: int, address: Address, value: int) -> None:
        """Let a drive report a requested value."""

    def wheel(self, rpm: int) -> None:
        """Command a speed to the left wheel."""

    def position(self, word: int, target: int) -> str | None:
        """Command a position to the lift in the ordinary way."""

    def resets(self) -> None:
        """Let the lift's drive be reset when nothing else stops it."""


class OverCan:
    def __init__(self) -> None:
        self.bench = guard_bench.Bench(find("rars"))
        self.now: Nanoseconds = 0

    def _states(self, packet: Packet) -> str | None:
        self.now += MILLISECOND
        before = self.bench.guard.refused
        self.bench.states(packet, now=self.now)
        return None if self.bench.guard.refused == before else self.bench.refusals[-1].reason

    def writes(self, node: int, address: Address, value: int) -> str | None:
        raw = guard_bench.raw(value, SIZES[address])
        return self._states(guard_bench.write(node, address.index, address.subindex, raw))

    def reports(self, node: int, address: Address, value: int) -> None:
        size = SIZES[address]
        head = bytes((0x43 | (4 - size) << 2,)) + address.index.to_bytes(2, "little") + b"\0"
        payload = head + guard_bench.raw(value, size).ljust(4, b"\0")
        self.bench.receives(Packet(guard_bench.LINK, 0x580 + node, payload), now=self.now)

    def wheel(self, rpm: int) -> None:
        assert self._states(guard_bench.wheel(LEFT, ENABLE, rpm)) is None

    def position(self, word: int, target: int) -> str | None:
        return self._states(guard_bench.position(LIFT, word, target))

    def resets(self) -> None:
        self._states(guard_bench.position(LIFT, 0, 0))
        self.now += 1000 * MILLISECOND
        assert self._states(guard_bench.frame(0, f"81 0{LIFT}")) is None


class OverSerial:
    def __init__(self) -> None:
        self.bench = serial_bench.SerialBench()
        self.now: Nanoseconds = 0

    def _states(self, packet: Packet) -> str | None:
        self.now += MILLISECOND
        before = self.bench.guard.refused
        self.bench.states(packet, now=self.now)
        if self.bench.guard.refused == before:
            self.bench.receives(serial_bench.done(packet), now=self.now)
            return None
        for sent in self.bench.refusals[-1].sent:
            self.bench.receives(serial_bench.done(sent), now=self.now)
        return self.bench.refusals[-1].reason

    def writes(self, node: int, address: Address, value: int) -> str | None:
        return self._states(serial_bench.writing(node, address, guard_bench.raw(value, SIZES[address])))

    def reports(self, node: int, address: Address, value: int) -> None:
        requested = serial_bench.reading(node, address)
        self.bench.states(requested, now=self.now)
        raw = guard_bench.raw(value, SIZES[address])
        self.bench.receives(serial_bench.value(requested, raw), now=self.now)

    def wheel(self, rpm: int) -> None:
        assert self._states(serial_bench.word(LEFT, ENABLE)) is None
        assert self._states(serial_bench.speed(rpm)) is None

    def position(self, word: int, target: int) -> str | None:
        self._states(serial_bench.target(LIFT, target))
        return self._states(serial_bench.word(LIFT, word))

    def resets(self) -> None:
        self._states(serial_bench.word(LIFT, 0))
        self.now += 1000 * MILLISECOND
        assert self._states(serial_bench.states(SendNmtService(LIFT, NmtCommand.RESET_NODE))) is None


Made: TypeAlias = Callable[[], Line]
BOTH: Final = pytest.mark.parametrize("made", [OverCan, OverSerial], ids=["can", "serial"])
PLACE: Final = 12_345
STEPS: Final = (
    ("writes", at.HOME_POSITION, PLACE),
    ("reports", at.HOME_POSITION, PLACE),
    ("writes", od.HOMING_METHOD, 35),
    ("reports", od.HOMING_METHOD, 35),
    ("writes", od.MODE, 6),
    ("reports", od.MODE_DISPLAY, 6),
    ("writes", od.CONTROLWORD, ENABLE),
)
"""All before the word that starts."""


def prepared(line: Line, *changed: tuple[str, Address, int], without: int | None = None) -> Line:
    """Do the steps, one left out, and then the changed ones."""
    line.reports(LIFT, od.STATUSWORD, ENABLED)
    line.position(HALT, 0)
    for place, (how, address, value) in enumerate(STEPS):
        if place != without:
            assert getattr(line, how)(LIFT, address, value) is None
    for how, address, value in changed:
        getattr(line, how)(LIFT, address, value)
    return line


@BOTH
def test_the_whole_of_it_passes(made: Made) -> None:
    line = prepared(made())
    assert line.writes(LIFT, od.CONTROLWORD, START) is None
    assert line.writes(LIFT, od.CONTROLWORD, HALT) is None
    assert line.writes(LIFT, od.MODE, 1) is None
    line.reports(LIFT, od.MODE_DISPLAY, 1)
    assert line.position(NEW_POSITION, PLACE) is None


@BOTH
@pytest.mark.parametrize("place", [0, LIFT_TOP])
def test_both_ends_of_the_travel_are_in_it(made: Made, place: int) -> None:
    line = prepared(made(), ("writes", at.HOME_POSITION, place), ("reports", at.HOME_POSITION, place))
    assert line.writes(LIFT, od.CONTROLWORD, START) is None


@BOTH
@pytest.mark.parametrize(("address", "value"), [(od.MODE, 1), (at.HOME_POSITION, 6)])
def test_what_is_no_order_to_home_leaves_the_drive_in_its_mode(
    made: Made, address: Address, value: int
) -> None:
    line = made()
    line.reports(LIFT, od.STATUSWORD, ENABLED)
    line.position(HALT, 0)
    assert line.writes(LIFT, address, value) is None
    assert line.position(NEW_POSITION, PLACE) is None


@BOTH
@pytest.mark.parametrize("without", [1, 3, 4, 5])
def test_the_start_needs_each_word_of_the_drives(made: Made, without: int) -> None:
    line = made()
    line.reports(LIFT, od.STATUSWORD, ENABLED)
    line.position(HALT, 0)
    for place, (how, address, value) in enumerate(STEPS):
        if place != without:
            getattr(line, how)(LIFT, address, value)
    assert (
        line.writes(LIFT, od.CONTROLWORD, START) == "the drive has not reported that its homing moves nothing"
    )


@BOTH
@pytest.mark.parametrize(
    ("address", "value"),
    [
        (od.HOMING_METHOD, 7),
        (od.HOMING_METHOD, 34),
        (od.HOMING_METHOD, -3),
        (at.HOME_POSITION, -1),
        (at.HOME_POSITION, LIFT_TOP + 1),
        (od.MODE_DISPLAY, 1),
        (od.MODE_DISPLAY, 7),
    ],
)
def test_and_it_must_be_the_right_word(made: Made, address: Address, value: int) -> None:
    line = prepared(made(), ("reports", address, value))
    assert line.writes(LIFT, od.CONTROLWORD, START) is not None


@BOTH
@pytest.mark.parametrize(
    ("address", "value"), [(od.HOMING_METHOD, 35), (at.HOME_POSITION, PLACE), (od.MODE, 6)]
)
def test_what_was_stated_before_it_was_written_again_counts_no_more(
    made: Made, address: Address, value: int
) -> None:
    line = prepared(made(), ("writes", address, value))
    assert line.writes(LIFT, od.CONTROLWORD, START) is not None


@BOTH
@pytest.mark.parametrize("address", [od.HOMING_METHOD, at.HOME_POSITION, od.MODE])
def test_nothing_of_it_while_another_axis_may_move(made: Made, address: Address) -> None:
    line = made()
    line.wheel(100)
    values = {od.HOMING_METHOD: 35, at.HOME_POSITION: PLACE, od.MODE: 6}
    assert line.writes(LIFT, address, values[address]) == f"{address} written while node 1 may move"


@BOTH
def test_no_new_position_in_homing_mode_and_no_other_mode_while_bit_4_is_up(made: Made) -> None:
    assert prepared(made()).position(NEW_POSITION, 0) == "a new position in homing mode"
    line = prepared(made())
    assert line.writes(LIFT, od.CONTROLWORD, START) is None
    assert line.writes(LIFT, od.MODE, 1) == "bit 4 is up, and would be a new position in another mode"


@pytest.mark.parametrize("unused", [b"\0\0\0", b"\x01\0\0", b"\xff\xff\xff"])
def test_bytes_of_a_write_that_are_not_used_do_not_count(unused: bytes) -> None:
    """CiA 301: an expedited download gives the number of its four bytes that contain no data."""
    line = OverCan()
    prepared(line)
    assert line.writes(LIFT, od.CONTROLWORD, START) is None
    mode = guard_bench.write(LIFT, od.MODE.index, od.MODE.subindex, b"\x01")
    packet = Packet(mode.link, mode.address, mode.payload[:5] + unused)
    reason, _ = line.bench.refuses(packet, now=line.now + 1)
    assert reason == "bit 4 is up, and would be a new position in another mode"


@BOTH
def test_a_drive_that_was_reset_has_stated_nothing(made: Made) -> None:
    line = prepared(made())
    line.resets()
    assert line.writes(LIFT, od.CONTROLWORD, START) is not None
    for how, address, value in STEPS[4:6]:
        getattr(line, how)(LIFT, address, value)
    assert line.writes(LIFT, od.CONTROLWORD, START) is not None, "its method may be another one now"


@BOTH
def test_a_drive_that_was_reset_is_in_its_own_mode(made: Made) -> None:
    line = prepared(made())
    line.resets()
    line.reports(LIFT, od.STATUSWORD, ENABLED)
    line.position(HALT, 0)
    assert line.position(NEW_POSITION, PLACE) is None


@BOTH
@pytest.mark.parametrize(
    ("node", "address", "value"),
    [
        (LIFT, at.HOME_POSITION, -1),
        (LIFT, at.HOME_POSITION, LIFT_TOP + 1),
        (STEER, at.HOME_POSITION, 134_954),
        (LIFT, od.HOMING_METHOD, 34),
        (LIFT, od.HOMING_METHOD, -1),
        (LIFT, od.MODE, 3),
        (LIFT, od.MODE, 7),
        (LEFT, at.HOME_POSITION, 0),
        (LEFT, od.HOMING_METHOD, 35),
        (LEFT, od.MODE, 6),
        (LEFT, od.CONTROLWORD, START),
        (LIFT, od.CONTROLWORD, START),
        (LIFT, od.CONTROLWORD, 0x005F),
    ],
)
def test_beyond_that_nothing_is_listed(made: Made, node: int, address: Address, value: int) -> None:
    assert made().writes(node, address, value) is not None


def test_outside_homing_mode_no_word_of_power_goes_by_sdo() -> None:
    for word in (ENABLE, HALT):
        assert OverCan().writes(LIFT, od.CONTROLWORD, word) == f"controlword 0x{word:04X} by object"


def test_a_start_by_process_data_is_never_listed() -> None:
    line = OverCan()
    prepared(line)
    assert line.position(START, 0) == "controlword 0x001F is not listed"


@BOTH
def test_after_it_the_lift_rests_where_the_drive_states_now(made: Made) -> None:
    """A far position before is near now: to hold it there is no motion, so the wheels may go."""
    line = prepared(made())
    for word in (START, HALT):
        assert line.writes(LIFT, od.CONTROLWORD, word) is None
    assert line.writes(LIFT, od.MODE, 1) is None
    line.reports(LIFT, od.MODE_DISPLAY, 1)
    line.wheel(100)
    assert line.position(NEW_POSITION, LIFT_TOP) is not None, "the lift may not move with the wheels"
