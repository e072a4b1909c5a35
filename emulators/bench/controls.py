"""The ground station's sticks and buttons, as the mission's steps move them, and what they say to the robot.

Signs and scales are written here anew, not taken from the bridge.
"""

import math
from typing import Final

import numpy as np

from emulators.bench.hand import Ramp, Tremor
from emulators.bench.mission import Button, Input, Mission, Step, steer_of_radius
from emulators.bench.strays import velocity
from firmware_bridge.robot import Robot
from firmware_bridge.teleop.mavlink import Message, dialect
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

PRESS: Final[Nanoseconds] = 120 * MILLISECOND
"""How long a tapped button is down: at least two messages."""
_FULL: Final = 1000
_UNUSED: Final = 0x7FFF
_BUTTONS: Final = {Button.DETECTOR: 1, Button.HEADLAMP: 2, Button.EMERGENCY_STOP: 4}
_LIFT_ENABLE: Final = 8


class Controls:
    """Speed, steer and lift as they are asked for, by sticks or as a twist, and the buttons."""

    __slots__ = (
        "_buttons", "_full_lift_rate", "_full_lock", "_full_speed", "_input", "_lift_rate", "_robot",
        "_speed", "_speed_tremor", "_steer", "_steer_tremor", "released_at",
    )  # fmt: skip

    def __init__(
        self, robot: Robot, mission: Mission, period: Nanoseconds, generator: np.random.Generator
    ) -> None:
        """Say something every `period`; `generator` is drawn from only where the mission has a tremor."""
        self.released_at: Nanoseconds = NEVER
        """When the button that is down comes up."""
        self._robot = robot
        self._full_speed: float = robot.limits.speed_mps
        self._full_lock: float = math.radians(robot.limits.steer_angle_deg)
        self._full_lift_rate: float = robot.limits.lift_rate_mps
        self._input = mission.input
        self._speed = Ramp()
        self._steer = Ramp()
        self._lift_rate = 0.0
        self._speed_tremor = Tremor(mission.noise.stick, period, generator)
        self._steer_tremor = Tremor(mission.noise.stick, period, generator)
        self._buttons = 0

    def move(self, step: Step, now: Nanoseconds) -> None:
        """Do with the hands what a step of the mission says."""
        self._input = step.input or self._input
        if step.speed_mps is not None:
            self._speed.go(step.speed_mps, step.ramp_mps2, now)
        if step.steer_deg is not None:
            self._steer.go(math.radians(step.steer_deg), None, now)
        if step.radius_m is not None:
            self._steer.go(steer_of_radius(self._robot, step.radius_m), None, now)
        if step.lift_rate_mps is not None:
            self._lift_rate = step.lift_rate_mps
        if step.press is not None:
            self._buttons = _BUTTONS[step.press]
            self.released_at = now + PRESS

    def release(self, now: Nanoseconds) -> None:
        """Let go of a button whose time is over."""
        if now >= self.released_at:
            self._buttons = 0
            self.released_at = NEVER

    def message(self, system: int, component: int, now: Nanoseconds) -> Message:
        """Return what the station says to this robot once a period: MANUAL_CONTROL, or a velocity."""
        speed, steer = self._speed.at(now), self._steer.at(now)
        speed_tremor, steer_tremor = self._speed_tremor.step(), self._steer_tremor.step()
        if speed != 0.0:  # a foot that is off the pedal does not tremble
            speed += speed_tremor * self._full_speed
            steer += steer_tremor * self._full_lock
        if self._input is Input.TWIST:
            yaw_rate = -speed * self._curvature(steer)
            return velocity(system, component, speed, yaw_rate)
        rate = self._lift_rate / self._full_lift_rate
        buttons = self._buttons | (_LIFT_ENABLE if rate else 0)
        return dialect.MAVLink_manual_control_message(
            system,
            _axis(speed / self._full_speed),
            _UNUSED,
            _axis(rate),
            _axis(-steer / self._full_lock),
            buttons,
        )

    def _curvature(self, steer_rad: float) -> float:
        if steer_rad == 0.0:
            return 0.0
        base = self._robot.base
        radius = base.kingpin_distance_m / 2.0 + base.wheelbase_m / math.tan(abs(steer_rad))
        return math.copysign(1.0 / radius, steer_rad)


def _axis(share: float) -> int:
    return max(-_FULL, min(round(_FULL * share), _FULL))
