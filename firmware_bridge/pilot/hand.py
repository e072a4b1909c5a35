"""A hand at the source's station: a helm, two pedals and a button for reverse.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, (4.1), Tab. 4.1, 4.3: full helm is full lock, the pedal
is the speed. Here the brake takes from it, and reverse changes only while no pedal is trodden on.
"""

from typing import Final

from firmware_bridge.pilot.driver import Sight, Stick
from firmware_bridge.pilot.joystick import Controls
from firmware_bridge.pilot.link import Link
from firmware_bridge.units import Nanoseconds

TRODDEN: Final = 0.05
"""Share of a pedal's way that is no play."""


class Hand:
    """A `firmware_bridge.pilot.driver.Driver`."""

    def __init__(self, controls: Controls) -> None:
        self.controls: Final = controls
        self.reverse = False

    def sees(self, sight: Sight) -> None:
        """See it: what to do about it is the human's business."""

    def press(self, button: int) -> None:
        """Change the direction, where that is the button and nobody is driving."""
        if button == self.controls.device.reverse and self.controls.accelerator < TRODDEN:
            self.reverse = not self.reverse

    def wish(self, _link: Link, _now: Nanoseconds, *, armed: bool) -> Stick:
        """Return where helm and pedals stand; nothing before the robot is armed."""
        controls = self.controls
        forward = max(controls.accelerator - controls.brake, 0.0) if armed else 0.0
        forward = 0.0 if forward < TRODDEN else forward
        return Stick(-forward if self.reverse else forward, controls.helm)
