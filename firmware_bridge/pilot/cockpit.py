"""A station with an operator: a joystick's or a keyboard's bytes come in beside the link's.

The content of its display is reported.
"""

import math
from collections.abc import Callable
from types import MappingProxyType
from typing import Final, TypeAlias

from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.driver import AtHand, ButtonRequest
from firmware_bridge.pilot.follower import PathDriver
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.units import NEVER, SECOND, Nanoseconds, to_seconds

HAND: Final = "hand"
"""The link that a joystick's or a keyboard's bytes come on."""
ARM: Final = ("arm", 400, (1.0,))
SAFETY_SWITCH: Final = ("emergency stop", 5300, (0.0,))
"""MAV_CMD_DO_SET_SAFETY_SWITCH_STATE; 0 is safe."""
ORDERS: Final = MappingProxyType({ButtonRequest.ARM: ARM, ButtonRequest.STOP: SAFETY_SWITCH})
DISARM: Final = ("disarm", 400, (0.0,))

Report: TypeAlias = Callable[[str], None]


class Cockpit:
    """A `Node` around the station; its driver is an operator, or a follower that may be armed by itself."""

    def __init__(
        self, station: PilotStation, report: Report, *, arms: bool = False, rolling: tuple[str, ...] = ()
    ) -> None:
        """Show the station's view, the rolling axes by these names.

        `arms`: arm the robot once it is received.
        """
        self._station: Final = station
        self._report: Final = report
        self._arms = arms
        """The robot is to be armed as soon as it is received."""
        self._wake_at: Nanoseconds = 0
        self._shows_at: Nanoseconds = 0
        self._rolling: Final = rolling
        self._lines_shown = 0
        """Count of the robot's texts reported so far."""

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take the robot's messages, or the operator's input."""
        if packet.link == HAND:
            self._handled(packet.payload, now)
            return Reaction((), self._due)
        reaction = self._station.receive(packet, now)
        # Once only: a robot that disarms itself must not be armed again by a program.
        if self._arms and self._station.shown.received:
            self._arms = False
            self._station.order(*ARM, now)
        return self._in_time(reaction, now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Say what is due, and show what is known once a second."""
        if now >= self._shows_at:
            self._shows_at = now + SECOND
            self._report(self.display(now))
        return self._in_time(self._station.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Let everything go, and disarm: one frame of each, what is lost then is silence."""
        # Ordered first, so that the one wake-up below sends it with the last stick.
        self._station.order(*DISARM, now)
        return Reaction(self._station.wake(now).sent, NEVER)

    def display(self, now: Nanoseconds) -> str:
        """Return the display's line: where it is, how it moves, and the link as both sides find it."""
        shown, link = self._station.shown, self._station.link
        trip = link.round_trip(now)
        words = ["armed" if shown.armed else "disarmed"]
        if shown.sight is not None:
            moving = shown.sight.moving
            words.append(f"x {moving.pose.x_m:.2f} m  y {moving.pose.y_m:.2f} m")
            words.append(
                f"heading {math.degrees(moving.pose.heading_rad):.0f} deg  {moving.speed_mps:.2f} m/s"
            )
        words += [f"{name} {value:.3g}" for name, value in shown.values.items()]
        words += [
            f"{name} {speed:.3g} rad/s" for name, speed in zip(self._rolling, shown.speeds, strict=False)
        ]
        if shown.battery_v is not None:
            words.append(f"battery {shown.battery_v:.1f} V")
        words.append("round trip unknown" if trip is None else f"round trip {to_seconds(trip):.2f} s")
        if link.lost is not None:
            words.append(f"lost {link.lost:.0%}")
        driver = self._station.driver
        if isinstance(driver, PathDriver):
            if driver.predictor is not None and driver.predictor.error_m is not None:
                words.append(f"predicted to {1000.0 * driver.predictor.error_m:.0f} mm")
            if driver.held_back:
                words.append(f"held back: {shown.warning or 'the robot does not say why'}")
        return "  ".join(words)

    @property
    def _due(self) -> Nanoseconds:
        return min(self._wake_at, self._shows_at)

    def _in_time(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        lines = self._station.shown.lines
        for line in lines[self._lines_shown :]:
            self._report(f"{to_seconds(now):9.3f} s  {line.text}")
        self._lines_shown = len(lines)
        self._wake_at = reaction.wake_at
        return Reaction(reaction.sent, self._due)

    def _handled(self, chunk: bytes, now: Nanoseconds) -> None:
        hand = self._station.driver
        if isinstance(hand, AtHand):
            for requested in hand.handle(chunk, now):
                self._station.order(*ORDERS[requested], now)
            self._wake_at = now
