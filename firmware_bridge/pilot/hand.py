"""A hand at the source's station: a helm, two pedals and a button for reverse.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, (4.1), Tab. 4.1, 4.3: full helm is full lock, the pedal
is the speed. Here the brake takes from it, and reverse changes only while no pedal is trodden on.
"""

from collections.abc import Iterator
from typing import Final

from firmware_bridge.pilot.at_standstill import SeenAtStandstill
from firmware_bridge.pilot.driver import NO_EXTRAS, ButtonRequest, Extras, Sight, Stick
from firmware_bridge.pilot.joystick import PLAY, Controls
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.units import Nanoseconds


class StickInput:
    """A `firmware_bridge.pilot.driver.AtHand`."""

    def __init__(self, controls: Controls, extras: Extras = NO_EXTRAS) -> None:
        self.controls: Final = controls
        self._extras: Final = extras
        self._seen: Final = SeenAtStandstill()
        self.reverse = False

    def sees(self, sight: Sight) -> None:
        """See it: what to do about it is the human's business."""

    def handle(self, chunk: bytes, _now: Nanoseconds) -> Iterator[ButtonRequest]:
        """Take the device's bytes; yield what its buttons ask for."""
        device = self.controls.device
        for button in self.controls.received(chunk):
            # Only with the pedal released: the sign would change at full speed otherwise.
            if button == device.reverse and self.controls.accelerator < PLAY:
                self.reverse = not self.reverse
            elif button == device.arm:
                self._seen.arm_requested()
                yield ButtonRequest.ARM
            elif button == device.stop:
                yield ButtonRequest.STOP

    def command(self, _link: PilotLink, _now: Nanoseconds, *, armed: bool) -> Stick:
        """Return where helm and pedals stand; once the robot is armed, of those that have rested since."""
        controls, counts = self.controls, self._seen.counts
        self._seen.look(controls.resting, armed=armed)
        # The brake takes nothing from it before: releasing the brake then would drive off.
        trodden = controls.accelerator - (controls.brake if armed else 0.0)
        forward = trodden if trodden >= PLAY and counts("accelerator") else 0.0
        held = [number for number, one in enumerate(controls.device.switches) if controls.held(one)]
        up, buttons = self._extras.encoded(controls.up if counts("up") else 0.0, held)
        helm = controls.helm if counts("helm") else 0.0
        return Stick(-forward if self.reverse else forward, helm, up, buttons)
