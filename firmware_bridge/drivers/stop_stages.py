"""The stop stages of a driver: the command of each, and the device's report that confirms it.

A stage that its device does not confirm in time is followed by the next one. The time of a stop is kept by
`firmware_bridge.bridge.stops`.
"""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

TAKEN_WITHIN: Final[Nanoseconds] = 5 * SECOND
"""From the begin of a stop to the end of its first stage that disables the power, in any case."""
CREEPS: Final[Nanoseconds] = 1_500 * MILLISECOND
"""So long, beside its ramp, may a stage last where the axis is seen to slow down: a speed loop creeps to
standstill behind its ramp, and another axis that coasts drags it on."""


@dataclass(frozen=True, slots=True)
class StopStage:
    """One stage. It is confirmed by standstill, or without torque; with `ends_power` without torque only."""

    name: str
    sent: str
    """The command to the device, for people."""
    set_point: Stop
    """The set-point meanwhile, unless a stronger stop is commanded."""
    within: Nanoseconds
    """Longest time of the device's report, beside the ramp's own time."""
    deceleration: float | None = None
    """Of that ramp, in the axis's unit a second squared; None: it does not count on one."""
    slows_within: Nanoseconds | None = None
    """An axis that is not seen to slow down is given only so long, beside the ramp; None: as long as any."""
    at_once: bool = False
    """The bridge does not ramp down before it."""
    transition: Transition | None = None
    """The driver's transition, once, at the begin."""
    whole_board: bool = False
    """No set-point does it for one axis alone: its transition begins also where it is the first stage."""
    ends_with_transition: bool = False
    """It is over when its transition is, whatever that has brought."""
    silent: bool = False
    """Meanwhile the link's devices are not shown that the bridge lives."""
    takes_all: bool = False
    """It disables the power of all on the link: not done for an axis at standstill in its last report."""
    received: bool = False
    """It needs a device that listens: where its power is not known the next stage is begun at once."""
    ends_power: bool = False
    ordered_off: bool = False
    """It belongs to a power-off that was ordered, in the place of the ramps."""
    note: str = ""
    """Further consequences, for people."""

    def lasts(self, speed: float) -> Nanoseconds:
        """Return how long it may take from this speed, in the axis's unit a second."""
        return self.within + self._ramp(speed)

    def judged_after(self, speed: float) -> Nanoseconds:
        """Return how long it takes from this speed at most where the axis does not slow down."""
        return (self.within if self.slows_within is None else self.slows_within) + self._ramp(speed)

    def _ramp(self, speed: float) -> Nanoseconds:
        return round(abs(speed) / self.deceleration * SECOND) if self.deceleration else 0


def sequence(stages: tuple[StopStage, ...], *, off: bool) -> tuple[StopStage, ...]:
    """Return the stages to standstill, or with `off` those that are left where the power was ordered off."""
    return tuple(stage for stage in stages if (stage.ends_power if off else not stage.ordered_off))


def gentle_within(stages: tuple[StopStage, ...]) -> Nanoseconds:
    """Return how long the stages before the first that disables the power may last together."""
    first = next((stage for stage in stages if stage.ends_power), None)
    return TAKEN_WITHIN - (first.within if first is not None else 0)


def sums(stages: tuple[StopStage, ...], speed: float) -> tuple[Nanoseconds, Nanoseconds]:
    """Return how long a stop lasts at most from this speed: until the power is taken, and in all."""
    first = next((place for place, stage in enumerate(stages) if stage.ends_power), len(stages) - 1)
    gentle = sum(stage.lasts(speed) for stage in stages[:first])
    # The gentle stages end after their common time, whatever each of them may last.
    taken = min(gentle, gentle_within(stages)) + stages[first].lasts(speed)
    return taken, taken + sum(stage.lasts(speed) for stage in stages[first + 1 :])
