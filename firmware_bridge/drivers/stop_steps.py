"""The steps of a stop, as a driver lays them out: what is sent, and which word of the device confirms it.

A step that its device does not confirm in time is followed by the next one. It refuses to know when a stop
is asked for; `firmware_bridge.bridge.stops` keeps the time.
"""

from dataclasses import dataclass

from firmware_bridge.drivers.driver import Stop, Task
from firmware_bridge.units import SECOND, Nanoseconds


@dataclass(frozen=True, slots=True)
class StopStep:
    """One step. It is confirmed by rest, or without torque; with `ends_power` without torque only."""

    name: str
    sent: str
    """What goes to the device, for people."""
    demand: Stop
    """What its set-points ask for meanwhile, unless they ask for more."""
    within: Nanoseconds
    """How long the device's word may take, beside the time that the ramp itself takes."""
    deceleration: float | None = None
    """Of that ramp, in the axis's unit a second squared; None: it does not count on one."""
    task: Task | None = None
    """What the device does once, at the begin."""
    ends_with_task: bool = False
    """It is over when its task is, whatever that has brought."""
    silent: bool = False
    """Meanwhile the link's devices are not shown that the bridge lives."""
    takes_all: bool = False
    """It takes the power of all on the link: not done for an axis that rested when it was last heard."""
    heard: bool = False
    """It needs a device that listens: where its power is not known the next step is begun at once."""
    ends_power: bool = False
    ordered_off: bool = False
    """It belongs to a power-off that was ordered, in the place of the ramps."""
    note: str = ""
    """What else follows from it, for people."""

    def lasts(self, speed: float) -> Nanoseconds:
        """Return how long it may take from this speed, in the axis's unit a second."""
        ramp = abs(speed) / self.deceleration if self.deceleration else 0.0
        return self.within + round(ramp * SECOND)


def way(steps: tuple[StopStep, ...], *, off: bool) -> tuple[StopStep, ...]:
    """Return the steps to rest, or with `off` those that are left where the power was ordered off."""
    return tuple(step for step in steps if (step.ends_power if off else not step.ordered_off))
