"""What holds of every bridge at every instant: it is looked at after each packet and each wake of every test.

* No joint state that `firmware_bridge.bridge.joint_state` forbids.
* While an emergency stop is latched, or the power was ordered off, no device is given power; but for a robot
  that would roll on a slope, which `power_down` holds.
* Only a request arms: the permission comes in the reaction to an operator's datagram.
* The first message of an emergency stop leaves in the cycle after its cause, on every bus that is there and
  moves something; on a serial line it waits for the answer that is outstanding.
* No speed that is commanded is larger than before, nor than what is allowed.

In the compiled core nothing can be looked at: its classes take no other methods.
"""

import math
import re
from types import FunctionType
from typing import Any, Final

from firmware_bridge.bridge.all_drivers import requests_stop
from firmware_bridge.bridge.bridge import Bridge
from firmware_bridge.bridge.joint_state import STOPS, Life, Motion, forbidden
from firmware_bridge.canopen import cia301
from firmware_bridge.drivers.life_cycle import DriverState
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot.table import Medium
from firmware_bridge.units import MILLISECOND, Nanoseconds

GIVES_POWER: Final = frozenset({DriverState.ACTIVATING, DriverState.RECOVERING})
SLACK: Final[Nanoseconds] = 20 * MILLISECOND
"""Beside a cycle: the devices' time to answer in it."""
ROUNDING: Final = 1e-6
RATE: Final = re.compile(r"\b(speed|rate|spin|brush)\b")
"""Titles of a motion's numbers that are speeds."""


def _periodic(packet: Packet) -> bool:
    """Return whether a packet is a SYNC or a heartbeat, which stop nothing."""
    return packet.address == cia301.SYNC or packet.address >= cia301.ERROR_CONTROL


class Watch:
    """One bridge, as it was at the last look."""

    __slots__ = ("commanded", "followed", "giving", "links_due", "motion", "phase", "stop_by")

    def __init__(self) -> None:
        self.motion = Motion.DISARMED
        self.phase = Life.STARTING
        self.giving = frozenset[str]()
        """The axes that are being given power."""
        self.followed: tuple[Any, Any] = (None, None)
        """The commanded and the allowed motion that were held against each other."""
        self.stop_by: Nanoseconds | None = None
        self.links_due = frozenset[str]()
        self.commanded: dict[str, float] = {}

    def look(self, bridge: Any, reaction: Reaction, now: Nanoseconds, *, operator: bool) -> None:
        """Hold the rules; AssertionError."""
        permission = bridge._permission  # noqa: SLF001 - it looks inside
        motion, before, phase = permission.motion, self.motion, bridge.phase
        if motion is not before or phase is not self.phase:
            why = forbidden(phase, motion)
            assert why is None, f"{phase.value} and {motion.value}: {why}"
            assert motion is before or motion is not Motion.ARMED or operator, "armed without a request"
        drivers = bridge._all_drivers.drivers  # noqa: SLF001 - as above
        giving = frozenset([one.axis.name for one in drivers if one.state in GIVES_POWER])
        if not giving <= self.giving and phase is Life.RUNNING and permission.forbids_power:
            given = ", ".join(sorted(giving - self.giving))
            assert permission.power_down.held, f"{motion.value}, and power is given to {given}"
        if phase is Life.RUNNING:
            self.follow(bridge)
        begins = motion in STOPS and before not in STOPS
        if begins or self.stop_by is not None:
            self._stops(bridge, reaction, now, begins=begins)
        self.motion, self.phase, self.giving = motion, phase, giving

    def _stops(self, bridge: Any, reaction: Reaction, now: Nanoseconds, *, begins: bool) -> None:
        lost = bridge._all_drivers.links_lost  # noqa: SLF001 - as above
        if begins and bridge.phase is Life.RUNNING:
            drivers = bridge._all_drivers  # noqa: SLF001 - as above
            moves = {name for name, one in drivers.set_points.items() if not requests_stop(one)}
            links = {one.axis.link for one in drivers.drivers if one.axis.name in moves}
            # On a line with an answer outstanding the stop is the next message.
            links = {one for one in links if bridge._pipeline._robot.links[one].medium is Medium.CAN}  # noqa: SLF001
            self.links_due = frozenset(links - set(lost))
            self.stop_by = now + bridge._cycle + SLACK  # noqa: SLF001 - as above
        if self.stop_by is not None:
            self.links_due -= {one.link for one in reaction.sent if not _periodic(one)} | set(lost)
            if bridge.phase is not Life.RUNNING or not self.links_due:
                self.stop_by = None
            else:
                late = ", ".join(sorted(self.links_due))
                assert now <= self.stop_by, f"an emergency stop, and nothing has left on {late}"

    def follow(self, bridge: Any) -> None:
        """Hold what the pipeline has commanded against what was allowed."""
        pipeline = bridge._pipeline  # noqa: SLF001 - as above
        # Once in a cycle; every other packet changes neither.
        commanded, allowed = pipeline._commanded, pipeline._allowed  # noqa: SLF001 - as above
        if self.followed[0] is commanded and self.followed[1] is allowed:
            return
        self.followed = (commanded, allowed)
        for title, number in pipeline._permission.rules.numbers.items():  # noqa: SLF001 - as above
            if not RATE.search(title):
                continue  # the command of an axis at rest is the place where it stands
            speed, limit = number(commanded), number(allowed)
            if speed is None or limit is None or not math.isfinite(speed):
                continue
            before = self.commanded.get(title, speed)
            most = max(abs(before), abs(limit))
            assert abs(speed) <= most + ROUNDING * max(1.0, most), (
                f"{title}: {speed:g} is commanded, {before:g} before, {limit:g} allowed"
            )
            self.commanded[title] = speed


def _watch(bridge: Any) -> Watch:
    # In the bridge itself: one that is taken back to an earlier instant takes its watch along.
    watch = getattr(bridge, "_watch", None)
    if watch is None:
        watch = bridge._watch = Watch()  # noqa: SLF001 - as above
    return watch


def install() -> bool:
    """Look at every bridge from now on; False where the core is compiled."""
    if not isinstance(vars(Bridge)["receive"], FunctionType):
        return False
    receive, wake, stop = Bridge.receive, Bridge.wake, Bridge.stop

    def received(bridge: Bridge, packet: Packet, now: Nanoseconds) -> Reaction:
        reaction = receive(bridge, packet, now)
        _watch(bridge).look(bridge, reaction, now, operator=packet.link == OPERATOR)
        return reaction

    def woken(bridge: Bridge, now: Nanoseconds) -> Reaction:
        reaction = wake(bridge, now)
        _watch(bridge).look(bridge, reaction, now, operator=False)
        return reaction

    def stopped(bridge: Bridge, now: Nanoseconds) -> Reaction:
        reaction = stop(bridge, now)
        _watch(bridge).look(bridge, reaction, now, operator=False)
        return reaction

    for name, method in (("receive", received), ("wake", woken), ("stop", stopped)):
        setattr(Bridge, name, method)
    return True
