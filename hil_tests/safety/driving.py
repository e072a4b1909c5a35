"""Robots that drive in virtual time, for tests of stops: what a test does in a branch is undone behind it."""

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import lru_cache
from typing import Final

from emulators.rig import BRIDGE
from emulators.testing.rig import STEP_S, VirtualRig
from firmware_bridge.bridge.stops import RAMPED_WITHIN, AxisStop, Progress
from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.motor_shield.driver.link_drivers import measured, over_protocol
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds

SPEEDS: Final = {"climber": 0.04}
"""m/s, where a robot is not as fast as the others."""
DRIVES_FOR_S: Final = 2.5
LOOKS_EVERY: Final[Nanoseconds] = from_seconds(STEP_S)
ORDERS: Final[dict[str, Callable[[VirtualRig], None]]] = {
    "emergency stop": lambda rig: rig.operator.stops(),
    "forced disarm": lambda rig: rig.operator.does(force_disarm=True),
    "Ctrl-C": lambda rig: rig.bench.world.stop(BRIDGE),
}
SHIELDS: Final = ("rome:mw:3", "rome:arduinoio:3", "rome+cameras:firmata", "rome:ros-arduino-bridge")
DRIVES: Final = ("rars", "rars+serial", "climber")
ARM: Final = "ar2"
SAMPLE: Final = 0x280
"""COB-ID of a drive's samples, TPDO 2, beside its node."""


def robot_of(name: str) -> AnyRobot:
    """Return a robot by `name`, `name+serial`, or `name:protocol:encoders`."""
    if name.endswith("+serial"):
        return over_serial(find(name.removesuffix("+serial")))
    robot, *more = name.split(":")
    protocol, encoders = (more + [None] * 2)[:2]
    return measured(over_protocol(find(robot), protocol, None if encoders is None else int(encoders)))


@contextmanager
def driving(name: str) -> Iterator[VirtualRig]:
    """Have a robot that drives straight on; what is done to it is undone at the end."""
    rig = _driving(name)
    try:
        with rig.branch():
            yield rig
    except BaseException:
        _driving.cache_clear()
        raise


@lru_cache(maxsize=3)
def _driving(name: str) -> VirtualRig:
    rig = VirtualRig(robot_of(name))
    rig.arms()
    if name == ARM:
        rig.operator.does(input="twist", speed_mps=0.02)
    else:
        rig.operator.drives(SPEEDS.get(rig.robot.kind, 0.3))
    rig.runs(DRIVES_FOR_S)
    return rig


def speed(rig: VirtualRig) -> float:
    """Return how fast it moves, m/s, by the plant: base or tool, turning counted at 0.15 m."""
    body, columns = rig.body, rig.body.columns
    ways = [body.speed_mps, body.speed_left_mps if "speed_left_mps" in columns else 0.0]
    tool = abs(body.tool_speed_mps) if "tool_speed_mps" in columns else 0.0
    return max(math.hypot(*ways), tool, 0.15 * abs(body.yaw_rate_rad_s))


def runs(rig: VirtualRig, seconds: float) -> float:
    """Run, and look at every stop each 10 ms; return for how long it still moved, s."""
    began, moved = rig.now, 0.0
    while rig.now < began + seconds:
        rig.runs(STEP_S)
        for stop in rig.bench.bridge.stops.values():
            check(stop, rig.bench.world.now, rig.robot.cycle * rig.robot.links[stop.link].every)
        if speed(rig) > 0.01:
            moved = rig.now - began
    return moved


def check(stop: AxisStop, now: Nanoseconds, cycle: Nanoseconds) -> None:
    """Check that a stage lasts as long as its row allows, and that the power is off in time, in any case."""
    if stop.progress is not Progress.UNDER_WAY:
        return
    axis, stage = stop.driver.axis, stop.stage
    most = stage.lasts(axis.top_speed) + (RAMPED_WITHIN if stop.place == 0 else 0)
    slack = 2 * cycle + LOOKS_EVERY
    assert now - stop.begun_at <= most + slack, (
        f"{axis.name}: {stage.name} since {to_seconds(stop.begun_at)} s"
    )
    first = next(place for place, one in enumerate(stop.stages) if one.ends_power)
    if stop.place <= first:
        assert now - stop.since <= TAKEN_WITHIN + slack, f"{axis.name}: {stage.name}, and power for too long"


@contextmanager
def changed(rig: VirtualRig, name: str, change: Callable[[Packet], tuple[Packet, ...]]) -> Iterator[None]:
    """Put what `change` makes of each packet in the place of what a station sends."""
    station = rig.bench.world._stations[name]  # noqa: SLF001 - no fault of a mission is as selective
    receive, wake = station.receive, station.wake

    def out(reaction: Reaction) -> Reaction:
        return Reaction(tuple([new for sent in reaction.sent for new in change(sent)]), reaction.wake_at)

    station.receive = lambda packet, now: out(receive(packet, now))
    station.wake = lambda now: out(wake(now))
    try:
        yield
    finally:
        station.receive, station.wake = receive, wake


def with_payload(packet: Packet, payload: bytes) -> Packet:
    """Return a packet with another payload."""
    return Packet(packet.link, packet.address, payload)


def image_frozen(node: int) -> Callable[[Packet], tuple[Packet, ...]]:
    """Return what makes a drive's samples on CAN repeat the first one for ever."""
    first: list[bytes] = []

    def change(packet: Packet) -> tuple[Packet, ...]:
        if packet.address != SAMPLE + node:
            return (packet,)
        first[:] = first or [packet.payload]
        return (with_payload(packet, first[0]),)

    return change
