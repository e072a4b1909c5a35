"""The ground station's sticks and buttons, as the mission's steps move them, and what they say to the robot.

Signs and scales are those of the robot's bench setup, written again, not taken from the bridge.
"""

from typing import Final

import numpy as np

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.foreign_datagrams import velocity
from emulators.bench.mission import Mission
from emulators.bench.step import Holds, Input, Presses, Slope, Step, inputs
from emulators.bench.stick import Ramp, Tremor
from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds

PRESS: Final[Nanoseconds] = 120 * MILLISECOND
"""Duration of a tap on a button: at least two messages."""
_FULL: Final = 1000
_UNUSED: Final = 0x7FFF


class Controls:
    """The operator's commands, channel by channel, by stick or as a twist, and the buttons."""

    def __init__(
        self,
        robot: AnyRobot,
        bench_setup: BenchSetup,
        mission: Mission,
        period: Nanoseconds,
        generator: np.random.Generator,
    ) -> None:
        """Send a message every `period`; `generator` is drawn from only where the mission has a tremor."""
        self.released_at: Nanoseconds = NEVER
        """Release time of the button that is down."""
        self._robot = robot
        self._bench_setup = bench_setup
        self._input = mission.input
        self._ramps = {channel.name: Ramp() for channel in bench_setup.channels}
        self._full = {channel.name: channel.full(robot) for channel in bench_setup.channels}
        trembling = [channel for channel in bench_setup.channels if channel.trembles_with]
        self._trembles_with = {channel.name: channel.trembles_with for channel in trembling}
        self._tremors = {
            channel.name: Tremor(mission.noise.stick, period, generator) for channel in trembling
        }
        self._buttons = 0

    def move(self, step: Step, now: Nanoseconds) -> None:
        """Set the controls as a step of the mission requires."""
        self._input = step.input or self._input
        rows = inputs(type(step))
        slopes = {row.channel: getattr(step, key) for key, row in rows.items() if isinstance(row, Slope)}
        for key, row in rows.items():
            value = getattr(step, key)
            if value is None:
                continue
            if isinstance(row, Holds):
                self._ramps[row.channel].go(row.into(value, self._robot), slopes.get(row.channel), now)
            elif isinstance(row, Presses):
                self._buttons = row.buttons[value]
                self.released_at = now + PRESS

    def release(self, now: Nanoseconds) -> None:
        """Let go of a button whose time is over."""
        if now >= self.released_at:
            self._buttons = 0
            self.released_at = NEVER

    def message(self, system: int, component: int, now: Nanoseconds, clock: Nanoseconds) -> Message:
        """Return the station's periodic message to this robot: MANUAL_CONTROL, or a velocity.

        `clock`: the present time of the station's own clock.
        """
        still = {name: ramp.at(now) for name, ramp in self._ramps.items()}
        values = dict(still)
        for name, tremor in self._tremors.items():
            # Drawn also at rest: the hand's sequence does not depend on what the mission does.
            kick = tremor.step()
            if still[self._trembles_with[name]] != 0.0:
                values[name] += kick * self._full[name]
        if self._input is Input.TWIST:
            twist = self._bench_setup.twist(values, self._robot)
            return velocity(
                system, component, twist.vx, twist.yaw_rate, vy=twist.vy, at_ms=max(clock, 0) // MILLISECOND
            )
        axes = self._bench_setup.stick(values, self._robot)
        return dialect.MAVLink_manual_control_message(
            system, _axis(axes.x), _axis(axes.y), _axis(axes.z), _axis(axes.r), self._buttons | axes.buttons
        )


def _axis(share: float | None) -> int:
    # INT16_MAX marks an axis that is not used (MANUAL_CONTROL); full stick is 1000.
    return _UNUSED if share is None else max(-_FULL, min(round(_FULL * share), _FULL))
