"""The servo's inputs: two limit switches and a home switch on fixed pins, shown in 0x60FD.

Assumed: a limit switch that is met, or headed into, is an error with the ramp of 0x605E; the way out of it
is free.
"""

from typing import Final

from emulators.canopen.homing_methods import Switch
from emulators.cia402.errors import NEGATIVE_LIMIT, POSITIVE_LIMIT
from emulators.drive.inputs import DriveInputs
from emulators.servo.axis import ServoAxis
from emulators.servo.pins import SWITCHES

PINS: Final = {
    Switch.NEGATIVE_LIMIT: 1 << SWITCHES["negative_limit"] - 1,
    Switch.POSITIVE_LIMIT: 1 << SWITCHES["positive_limit"] - 1,
    Switch.HOME: 1 << SWITCHES["home"] - 1,
}
"""The axis' pins of the switches."""
LIMITS: Final = (
    (Switch.NEGATIVE_LIMIT.bit, -1, NEGATIVE_LIMIT),
    (Switch.POSITIVE_LIMIT.bit, 1, POSITIVE_LIMIT),
)


class ServoInputs(DriveInputs):
    """The switches by their bits in 0x60FD."""

    def __init__(self, axis: ServoAxis) -> None:
        super().__init__()
        self._axis: Final = axis
        self.fitted = sum(switch.bit for switch in PINS)

    def reset(self) -> None:
        """Begin as after power-on, once the axis has."""
        # Their edges wake the drive.
        self._axis.pins_watched = sum(PINS.values())
        self.executed = 0
        self.refresh()

    def shown(self) -> int:
        """Return 0x60FD."""
        return sum(switch.bit for switch, pin in PINS.items() if self._axis.pins & pin)

    def refresh(self) -> None:
        """Take in the switches as the axis has sampled them last."""
        before, self.active = self.active, self.shown()
        self.executed = self.active
        self.risen = self.active & ~before

    def limits_met(self, heading: int, sought: int) -> tuple[int, ...]:
        """Return the emergencies of the limit switches that have just been met, or are headed into."""
        return tuple(
            code
            for bit, direction, code in LIMITS
            if self.executed & ~sought & bit and (self.risen & bit or heading == direction)
        )
