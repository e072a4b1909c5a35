"""A stop gets through in every state of a driver and on every link; each stage lasts as its row allows."""

from collections.abc import Callable
from contextlib import ExitStack, suppress
from itertools import cycle
from typing import Final, TypeAlias

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from emulators.testing.errors import RigError
from emulators.testing.rig import VirtualRig
from firmware_bridge.bridge.stops import Progress
from firmware_bridge.drivers.all_drivers import stop_stages_of
from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN, sequence, sums
from firmware_bridge.families.motor_shield.settings import ShieldLink
from firmware_bridge.packet import Packet
from firmware_bridge.runtime.runner import STOP_WITHIN
from firmware_bridge.units import to_seconds
from hil_tests.lanes import examples
from hil_tests.rows import every
from hil_tests.safety.driving import (
    ARM,
    DRIVES,
    ORDERS,
    SHIELDS,
    changed,
    driving,
    image_frozen,
    robot_of,
    runs,
    speed,
    with_payload,
)

ROLLS_OUT_S = 2.5
"""A wheel without power rolls for so long at most, of those here."""
each_order = every("order", ORDERS.items(), ids=lambda it: it[0])


def whole_stop_s(rig: VirtualRig) -> float:
    """Return the longest duration of a stop, every stage of it."""
    robot = rig.robot
    whole = [sums(sequence(stop_stages_of(robot, axis), off=False), axis.top_speed)[1] for axis in robot.axes]
    return to_seconds(max(whole))


def ended(rig: VirtualRig) -> bool:
    """Return True if every stop is confirmed, or given up."""
    over = (Progress.CONFIRMED, Progress.GIVEN_UP, Progress.NOT_REQUESTED)
    return all(stop.progress in over for stop in rig.bench.bridge.stops.values())


@pytest.mark.long(keeps=["20"])
@every("robot", SHIELDS)
@each_order
@pytest.mark.parametrize("every_ms", [20, 50])
def test_a_board_that_prints_without_end_is_stopped(
    robot: str, order: tuple[str, Callable[[VirtualRig], None]], every_ms: int
) -> None:
    """Its line was silent for 1.5 s: it is set up again, and what it prints does not put that off."""
    with driving(robot) as rig:
        rig.fault("board_chatters", every_ms=every_ms)
        runs(rig, 0.5)
        rig.fault("board_silent", for_s=1.5)
        runs(rig, 3.0)
        order[1](rig)
        assert runs(rig, 8.0) < 2.8
        assert speed(rig) < 0.005


@pytest.mark.long(keeps=["0.5"])
@each_order
@pytest.mark.parametrize("silent_s", [0.0, 0.5, 1.5])
def test_two_stray_bytes_to_firmata_keep_no_stop(
    order: tuple[str, Callable[[VirtualRig], None]], silent_s: float
) -> None:
    """C0 01 switches an analog report on, 53 times a second from then on."""
    with driving("rome+cameras:firmata") as rig:
        (line,) = rig.bench.lines.values()
        bridge = rig.bench.world._stations["bridge"]  # noqa: SLF001 - a disturbance that the bridge does not see
        line.wire.carry(bridge, Packet(next(iter(rig.bench.lines)), 0, b"\xc0\x01"))
        runs(rig, 0.3)
        if silent_s:
            rig.fault("board_silent", for_s=silent_s)
        runs(rig, silent_s + 3.0)
        order[1](rig)
        runs(rig, 6.0)
        assert speed(rig) < 0.005


@every("robot", ["rars", "climber"])
@each_order
def test_a_drive_that_hangs_loses_its_power_in_time(
    robot: str, order: tuple[str, Callable[[VirtualRig], None]]
) -> None:
    """It reports that it is enabled, and where it hung; its regulator goes on with its target."""
    with driving(robot) as rig, changed(rig, "left", image_frozen(1)):
        rig.fault("set_points_ignored", node="left")
        runs(rig, 0.05)
        order[1](rig)
        left = next(axis for axis in rig.bench.devices.axes if axis.name == "left")
        runs(rig, 2.0)
        assert not left.powered
        assert runs(rig, 6.0) < ROLLS_OUT_S
        assert not rig.body.armed


@every("robot", ["rars", "climber"])
@every("order", [("forced disarm", 0.7), ("emergency stop", 1.2), ("Ctrl-C", 1.2)], ids=lambda it: it[0])
def test_a_drive_that_receives_nothing_at_standstill_loses_its_power_as_its_rows_say(
    robot: str, order: tuple[str, float]
) -> None:
    """Delays: PDO 150 ms, SDO 200 ms, timeout 350 ms; emergency stop and end first look for half a second."""
    with driving(robot) as rig:
        rig.operator.returns_to_neutral()
        runs(rig, 2.0)
        rig.fault("set_points_ignored", node="left")
        left = next(axis for axis in rig.bench.devices.axes if axis.name == "left")
        ORDERS[order[0]](rig)
        runs(rig, order[1])
        assert not left.powered


@pytest.mark.long(keeps=[SHIELDS[0]])
@pytest.mark.parametrize("robot", [ARM, *SHIELDS])
@every("fault", ["board_silent", "board_brown_out", "board_hangs"])
def test_the_end_of_the_program_comes_whatever_the_board_does(robot: str, fault: str) -> None:
    with driving(robot) as rig:
        rig.fault(fault)
        runs(rig, 0.3)
        ORDERS["Ctrl-C"](rig)
        runs(rig, to_seconds(STOP_WITHIN))
        assert rig.bench.bridge.finished, "no one cuts it off"
        assert bool(rig.bench.bridge.not_acknowledged) is (fault != "board_hangs")


def test_an_order_begins_a_stop_again_that_nothing_brought_about() -> None:
    with driving("rome:mw:3") as rig:
        rig.fault("board_silent", for_s=12.0)
        runs(rig, 10.0)
        stops = rig.bench.bridge.stops.values()
        assert {stop.progress for stop in stops} == {Progress.GIVEN_UP}
        assert "nothing is left to try" in rig.interlock_events["stop not acknowledged: one"]
        rig.operator.stops()
        runs(rig, 0.2)
        assert {stop.progress for stop in stops} == {Progress.UNDER_WAY}
        runs(rig, 6.0)
        assert speed(rig) < 0.005


@every("robot", (*SHIELDS, *DRIVES, ARM, "diff_drive"))
def test_the_power_is_taken_within_five_seconds_by_the_rows(robot: str) -> None:
    machine = robot_of(robot)
    for axis in machine.axes:
        stages = stop_stages_of(machine, axis)
        for off in (False, True):
            taken, whole = sums(sequence(stages, off=off), axis.top_speed)
            assert taken <= TAKEN_WITHIN
            boots = max((getattr(link, "boots_within_ms", 0) for link in machine.links.values()), default=0)
            assert to_seconds(whole - taken) <= 4.0 + boots / 1000.0, "silence, and the reset"


Behaviors: TypeAlias = dict[str, tuple[str, dict[str, object]]]
"""Behavior of a link, or of a device on it: a fault and its keys; an empty kind for none."""
ON_A_LINE: Final[Behaviors] = {
    "as it should be": ("", {}),
    "silent": ("board_silent", {}),
    "chatters": ("board_chatters", {"every_ms": 20}),
    "garbage": ("line_garbage", {"every_ms": 20}),
    "reset": ("board_reset", {}),
    "hangs": ("board_hangs", {}),
    "bus stuck": ("i2c_stuck", {}),
    "half answers": ("", {}),
    "every other answer": ("", {}),
}
ON_A_BUS: Final[Behaviors] = {
    "as it should be": ("", {}),
    "silent": ("node_silent", {"node": "left"}),
    "restarts": ("drive_restart", {"node": "left"}),
    "ignores": ("set_points_ignored", {"node": "left"}),
    "frozen": ("encoder_frozen", {"node": "left"}),
    "frames lost": ("frame_loss", {"share": 0.5}),
    "chatters": ("stray_frames", {"identifier": 0x701, "data": "7F", "every_ms": 2}),
    "boot-ups": ("stray_frames", {"identifier": 0x701, "data": "00", "every_ms": 50}),
}
INSTANTS: Final = {"board_reset", "board_hangs"}
ON_CAN: Final = {"stray_frames", "frame_loss"}
HELPLESS = {"silent", "garbage", "hangs", "bus stuck"}
"""Behaviors in which a board without a watchdog may run on, and every stage is tried in vain."""


def behave(rig: VirtualRig, what: str, seconds: float, stack: ExitStack) -> None:
    """Let a link or what is on it behave so, for so long; nothing where two cannot be at once."""
    kind, keys = (ON_A_LINE if ShieldLink.all_of(rig.robot) else ON_A_BUS)[what]
    if what == "half answers":
        stack.enter_context(changed(rig, "board", half))
    elif what == "every other answer":
        stack.enter_context(changed(rig, "board", others()))
    elif kind:
        lasts = {} if kind in INSTANTS else {"for_s": seconds}
        with suppress(RigError):
            rig.fault(kind, **keys, **lasts)


def half(packet: Packet) -> tuple[Packet, ...]:
    """Lose the second half of each chunk from a board."""
    return (with_payload(packet, packet.payload[: len(packet.payload) // 2]),)


def others() -> Callable[[Packet], tuple[Packet, ...]]:
    """Lose every other chunk."""
    ways = cycle((True, False))
    return lambda packet: (packet,) if next(ways) else ()


def stories(kinds: Behaviors, seconds: list[float]) -> st.SearchStrategy[list[tuple[str, float]]]:
    """Return what happens one after the other, each kind once at most, and for how long."""
    one = st.tuples(st.sampled_from(sorted(kinds)), st.sampled_from(seconds))
    return st.lists(one, min_size=1, max_size=3, unique_by=lambda it: it[0])


@pytest.mark.timeout(0)
@settings(max_examples=examples(60))
@given(
    robot=st.sampled_from(SHIELDS),
    story=stories(ON_A_LINE, [0.1, 0.45, 1.5, 3.0]),
    order=st.sampled_from(sorted(ORDERS)),
)
@example(robot="rome:mw:3", story=[("silent", 1.5), ("chatters", 3.0)], order="Ctrl-C")
@example(robot="rome:arduinoio:3", story=[("reset", 0.1), ("half answers", 3.0)], order="forced disarm")
@example(robot="rome:mw:3", story=[("half answers", 0.1)], order="Ctrl-C")
@example(robot="rome:ros-arduino-bridge", story=[("every other answer", 3.0)], order="Ctrl-C")
def test_whatever_a_board_and_its_line_do_each_stage_lasts_what_its_row_states(
    robot: str, story: list[tuple[str, float]], order: str
) -> None:
    with driving(robot) as rig, ExitStack() as stack:
        for what, seconds in story:
            behave(rig, what, seconds + 20.0, stack)
            runs(rig, seconds)
        ORDERS[order](rig)
        runs(rig, 0.1)
        within = rig.now + whole_stop_s(rig) + 0.5
        while not ended(rig):
            assert rig.now < within
            runs(rig, 0.05)
        given_up = any(stop.progress is Progress.GIVEN_UP for stop in rig.bench.bridge.stops.values())
        runs(rig, ROLLS_OUT_S)
        assert speed(rig) < 0.01 or given_up or rig.bench.bridge.not_acknowledged
        if not {what for what, _ in story} & HELPLESS:
            assert speed(rig) < 0.01


@pytest.mark.timeout(0)
@settings(max_examples=examples(60))
@given(
    robot=st.sampled_from(DRIVES),
    story=st.lists(
        st.tuples(st.sampled_from(sorted(ON_A_BUS)), st.sampled_from([0.05, 0.3, 1.0])),
        min_size=1,
        max_size=3,
    ),
    order=st.sampled_from(sorted(ORDERS)),
)
@example(robot="rars", story=[("ignores", 0.05), ("frozen", 0.05)], order="Ctrl-C")
def test_whatever_a_drive_and_its_bus_do_it_stops_in_time(
    robot: str, story: list[tuple[str, float]], order: str
) -> None:
    with driving(robot) as rig, ExitStack() as stack:
        for what, seconds in story:
            if ON_A_BUS[what][0] in ON_CAN and robot.endswith("+serial"):
                continue
            behave(rig, what, 6.0, stack)
            runs(rig, seconds)
        ORDERS[order](rig)
        runs(rig, to_seconds(TAKEN_WITHIN) + ROLLS_OUT_S)
        powered = {axis.name for axis in rig.bench.devices.axes if axis.powered}
        assert speed(rig) < 0.01 or not powered & {"left", "right"}, "what moves has no power"
