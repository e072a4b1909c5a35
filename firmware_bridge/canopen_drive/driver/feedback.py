"""The newest data of one drive, and their meaning for the bridge: SI units, five power states.

CAN frames and serial answers fill it in; tasks and set-points look into it.
"""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.canopen.cia402 import PowerState, Status
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.scale import Scale, wrapped
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.drivers.driver import Between, Feedback, Power
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.robot import Axis
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

POWERED: Final = (
    PowerState.REFRESH,
    PowerState.MEASURE_INIT,
    PowerState.OPERATION_ENABLED,
    PowerState.QUICK_STOP_ACTIVE,
    PowerState.FAULT_REACTION_ENABLED,
)
"""States in which the motor may have torque."""
FAULT_STATES: Final = (
    PowerState.FAULT,
    PowerState.FAULT_REACTION_DISABLED,
    PowerState.FAULT_REACTION_ENABLED,
)
_POWERS: Final = {
    **dict.fromkeys(PowerState, Power.OFF),
    PowerState.OPERATION_ENABLED: Power.ON,
    PowerState.QUICK_STOP_ACTIVE: Power.STOPPED,
    **dict.fromkeys(FAULT_STATES, Power.FAULT),
}
_SHOWN: Final[Mapping[PowerState | None, tuple[Power, str]]] = {
    None: (Power.UNKNOWN, ""),
    **{state: (_POWERS[state], state.title) for state in PowerState},
}
"""Power and text of each state."""
POSITIONS_APART: Final = (2 * MILLISECOND, 30 * MILLISECOND)
"""Least and most time between two positions that give a speed: less is the bus' jitter, more is a gap."""
_ATTAINED: Final = int(Status.HOMING_ATTAINED)


class DriveFeedback:
    """One drive's record."""

    def __init__(self, axis: Axis, product: DriveProduct) -> None:
        self._axis: Final = axis.name
        self._scale: Final = Scale.of(axis)
        self.product: Final = product
        self._states: Final = product.states
        self._referenced: Final = product.referenced
        self._amperes: Final = axis.direction * product.amperes
        self._top_speed: Final = axis.top_speed
        self._lead_s: Final = DriveAxis.of(axis).position_lead_ms / 1000.0
        self.state: PowerState | None = None
        """None while it is unknown, or the drive does not listen to set-points."""
        self.statusword = 0
        self.operational = False
        """True while the drive receives set-points."""
        self.found_operational: bool | None = None
        """True where it received them when it was first found; None before that."""
        self.restarted = False
        """True where it booted since it was found: its set-up is lost."""
        self.rewritten = ""
        """Foreign writes to its objects since it was set up: its set-up may be lost."""
        self.expected = False
        """True once this bridge has defined the data of a cycle, which count only from then on."""
        self.received_at: Nanoseconds = NEVER_RECEIVED
        self.sampled_at: Nanoseconds = NEVER_RECEIVED
        self.position_counts = 0
        """Counted on across the wrap of the drive's counter."""
        self.velocity = 0.0
        """In the axis's unit a second, the mean between the last two samples."""
        self.between: Between | None = None
        """The newest position, where it sends some between samples; None before the first."""
        self.current = 0
        """In the drive's own unit."""
        self.current_at: Nanoseconds = NEVER_RECEIVED
        """Time of its arrival."""
        self.fault = 0
        """Code of the newest emergency; 0 where there is none, or it was reset."""
        self.unpowered = False
        """True where the newest Statusword has a state without torque; False again after a power request."""

        self.reference_lost = not self._referenced
        """True where a Statusword has reported this, or it restarted, since it was referenced.

        Of a drive that cannot report it: until it is referenced by this bridge.
        """
        self.zeroing = False
        """True while its counter is being set: a difference between two samples then is no motion."""
        self.seeking = False
        """True while it moves for homing; its counter is set when it reports homing attained."""

    def on_statusword(self, statusword: int) -> PowerState | None:
        """Take a Statusword from any link, whether the drive receives set-points or not.

        Return its state.

        Assumed: switching off or a reset clears the bits of a known position, homing by any method sets them.
        """
        self.statusword = statusword
        if statusword & self._referenced != self._referenced:
            self.reference_lost = True
        # Bit 12 in homing mode: from here on the count may jump, which is no motion.
        if self.seeking and statusword & _ATTAINED:
            self.zeroing = True
        state = self._states.state_of(statusword)
        # An unknown pattern proves nothing, so it does not count as without power.
        self.unpowered = state is not None and state not in POWERED
        return state

    def moved_to(self, counter: int) -> int:
        """Return the way in counts from the newest position to what the drive's counter shows now."""
        # Less than half the counter between two samples: the sign of the difference is then certain.
        return wrapped(counter - self.position_counts)

    def move(self, counts: int, elapsed: Nanoseconds) -> None:
        """Take the mean velocity from a way and its time."""
        self.velocity = counts / self._scale.counts_per_unit / to_seconds(elapsed)

    def passes(self, counter: int, now: Nanoseconds) -> None:
        """Take a position between two samples."""
        # Without a sample in the same count there is nothing to add it to.
        if self.sampled_at != NEVER_RECEIVED and not self.zeroing:
            position = self._scale.position(self.position_counts + self.moved_to(counter))
            self.between = Between(now, position, position + self._lead(position, now))

    def _lead(self, position: float, now: Nanoseconds) -> float:
        """Return how far it will go in the robot file's lead, at its speed since the position before."""
        before = self.between
        if before is None or not POSITIONS_APART[0] <= now - before.at <= POSITIONS_APART[1]:
            return 0.0
        speed = (position - before.position) / to_seconds(now - before.at)
        # A position that jumps leads the others no further than the axis can go.
        return min(max(speed, -self._top_speed), self._top_speed) * self._lead_s

    def forget_motion(self) -> None:
        """Count again from the next sample on: no way and no velocity from before to after."""
        self.sampled_at = NEVER_RECEIVED
        self.velocity = 0.0
        self.between = None

    def restart(self) -> None:
        """Learn that it has restarted: set-up and zero are lost, and its counter begins again."""
        self.restarted = self.reference_lost = True
        self.expected = False
        self.forget_motion()

    def lose_reference(self) -> None:
        """Learn that no one knows whether its counter was set already: what was to set it has ended."""
        self.reference_lost, self.zeroing, self.seeking = True, False, False
        self.forget_motion()

    def reference_set(self, counter: int) -> None:
        """Count from the zero that was just set; that is what the drive's counter shows by it."""
        self.reference_lost = self.zeroing = self.seeking = False
        self.position_counts = counter
        self.forget_motion()

    def in_words(self, code: int) -> str:
        """Return an error's code, and its cause where it is known."""
        cause = self.product.causes.get(code)
        return f"0x{code:04X}" + (f", {cause}" if cause else "")

    def published(self) -> Feedback:
        """Return its published state."""
        fault = self.fault
        power, text = _SHOWN[self.state]
        return Feedback(
            axis=self._axis,
            power=power,
            received_at=self.received_at,
            sampled_at=self.sampled_at,
            position=self._scale.position(self.position_counts),
            velocity=self.velocity,
            current_a=self.current * self._amperes,
            current_at=self.current_at,
            fault=self.in_words(fault) if fault else "",
            text=text,
            reference_lost=self.reference_lost,
            rewritten=self.rewritten,
        )
