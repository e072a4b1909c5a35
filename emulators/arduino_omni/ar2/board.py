"""The arm's board, whole: a Mega on USB with a generation of its sketch, and the arm on its drivers.

It does not depend on the host at the other end of the USB. This board carries no motor shield.
"""

from typing import Final

from emulators.arduino_omni.ar2.firmwares import Firmware
from emulators.arduino_omni.ar2.joints import Joints
from emulators.arduino_omni.ar2.sketch import Ar2Sketch
from emulators.arduino_omni.mega.mega import Mega
from emulators.arduino_omni.usb_board import UsbBoard
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds

MOVES_EVERY: Final[Nanoseconds] = 50 * MILLISECOND
"""An arm that swings is moved on so often at least, so that an idle board has nothing to catch up with."""


class Ar2Board:
    """A board as a node on the link "serial", its USB. The first call of `wake` is power-on."""

    def __init__(self, firmware: Firmware, joints: Joints | None = None) -> None:
        """Flash a generation of the sketch; the arm stands at rest unless it is brought along."""
        self.joints: Final = Joints() if joints is None else joints
        self.mega: Final = Mega(
            lambda mega: Ar2Sketch(mega, self.joints, firmware), firmware.baud, shafts=self.joints
        )
        self._usb: Final = UsbBoard(self.mega)

    @property
    def moves(self) -> bool:
        """True while the sketch executes a move."""
        sketch = self.mega.sketch
        return isinstance(sketch, Ar2Sketch) and sketch.moves

    def reset(self, now: Nanoseconds) -> None:
        """Reset the board by its button: a move ends where it is."""
        self._usb.reset(now)

    def hang(self, now: Nanoseconds) -> None:
        """Let its firmware do nothing more; the motors hold what they hold."""
        self._usb.hang(now)

    def advance(self, now: Nanoseconds) -> None:
        """Advance to `now`, for observers of the arm; bytes that the board sends stay queued."""
        self._usb.advance(now)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a chunk from the host, or what became of DTR."""
        return self._moved(self._usb.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the board on."""
        return self._moved(self._usb.wake(now), now)

    def _moved(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        if not self.joints.swings:
            return reaction
        self.joints.reach(now)
        return Reaction(reaction.sent, min(reaction.wake_at, now + MOVES_EVERY))
