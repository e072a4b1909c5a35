"""A bridge that is ended at any instant of its start leaves drives as they were, or without power."""

from typing import TYPE_CHECKING, Final

import pytest

from emulators.epos2.drive import Epos2
from emulators.rewind import Checkpoint
from emulators.wires import DatagramWire
from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.node import OPERATOR
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find, robot_type_of
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import MILLISECOND, SECOND, to_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, step

if TYPE_CHECKING:
    from emulators.world import Wire

RARS: Final[AnyRobot] = find("rars")
ENDS_WITHIN_S: Final = 5.0
LEFT_ALONE: Final = SECOND


def network(one: Ride) -> set[NmtState]:
    return {drive.nmt_state for drive in one.rig.devices.nodes(Epos2).values()}


def assert_left(one: Ride, found: set[NmtState], when: str) -> None:
    """No power, and the network state as it was found; a watch that is off is off without power only."""
    assert not any(axis.powered for axis in one.rig.devices.axes), when
    assert network(one) <= {*found, NmtState.OPERATIONAL}, when


def instants(one: Ride, bridge: Bridge) -> list[Checkpoint]:
    """Keep every millisecond of the start-up in which some frame was on the bus."""
    kept, frames = [], -1
    while bridge.phase is Life.STARTING:
        if one.rig.can_wire.frames != frames:
            frames = one.rig.can_wire.frames
            kept.append(one.rig.snapshot())
        one.rig.world.run(one.rig.world.now + MILLISECOND)
    return kept


def ended_at_each(one: Ride, name: str, bridge: Bridge, found: set[NmtState]) -> int:
    """End the bridge at each of these instants; return how many they were."""
    moments = instants(one, bridge)
    for moment in moments:
        one.rig.restore(moment)
        moment_began = one.rig.world.now
        began = to_seconds(moment_began)
        one.rig.world.stop(name)
        while not bridge.finished:
            one.rig.world.run(one.rig.world.now + 20 * MILLISECOND)
            assert to_seconds(one.rig.world.now) < began + ENDS_WITHIN_S, f"ended at {began:.4f} s"
        assert bridge.not_acknowledged == ()
        if one.rig.world.now == moment_began:
            # It was only listening, and has left them to their own watch.
            one.rig.world.run(one.rig.world.now + LEFT_ALONE)
        assert_left(one, found, f"ended at {began:.4f} s")
    return len(moments)


def test_drives_that_were_just_switched_on_are_left_pre_operational_and_without_power(rides: Ridden) -> None:
    one = rides(ARMED, seconds=20, seed=1)
    one.rig.world.run(0)
    assert ended_at_each(one, "bridge", one.rig.bridge, {NmtState.PRE_OPERATIONAL}) > 20


@pytest.mark.long(beside="test_drives_that_were_just_switched_on_are_left_pre_operational_and_without_power")
def test_drives_that_a_dead_bridge_has_left_are_left_operational_and_without_power(rides: Ridden) -> None:
    """Their own watch has stopped them while the next bridge listens."""
    one = rides(ARMED, step(4.0, speed_mps=0.3), seconds=20, seed=1)
    one.runs_until(5.0)
    one.rig.world.silence("bridge", one.rig.world.now)
    one.rig.runs(0.01)
    second = Bridge(RARS, robot_type_of(RARS))
    links: dict[str, Wire] = {"drives": one.rig.can_wire, OPERATOR: DatagramWire()}
    one.rig.world.attach("second", guarded(second, RARS), links)
    one.rig.world.run(one.rig.world.now)
    assert network(one) == {NmtState.OPERATIONAL}
    assert ended_at_each(one, "second", second, {NmtState.OPERATIONAL}) > 20
    assert {drive.store.get(od.CONSUMER_HEARTBEAT_1) for drive in one.rig.devices.nodes(Epos2).values()} == {
        0
    }
