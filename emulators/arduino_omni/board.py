"""A whole board: a Mega on USB with its shield, one of four firmwares on it, and motors at its terminals.

Not known here: who is on the other end of the USB, and what the motors turn.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from emulators.arduino_omni.mega.mega import Mega, Sketch
from emulators.arduino_omni.mega.pins import ENCODER_PINS
from emulators.arduino_omni.motors import SUPPLY_V, MotorLoad, Motors
from emulators.arduino_omni.shield.motor_shield import MotorShield
from emulators.arduino_omni.sketches.arduinoio import ArduinoIoSketch
from emulators.arduino_omni.sketches.firmata import FirmataSketch
from emulators.arduino_omni.sketches.mw import MwSketch
from emulators.arduino_omni.sketches.ros_arduino_bridge import AUTO_STOP, RosSketch
from emulators.arduino_omni.usb_board import UsbBoard
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, mw, ros_arduino_bridge
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MILLISECOND, Nanoseconds

MOVES_EVERY: Final[Nanoseconds] = 50 * MILLISECOND
"""Motors are moved on so often at least, so that an idle board has nothing to catch up with."""


@dataclass(frozen=True, slots=True)
class Firmware:
    """A firmware that can be flashed: the sketch takes the board, its encoders and its auto-stop in ms."""

    title: str
    baud: int
    encoders: tuple[int, ...]
    """Numbers of encoders that it can be built to count; the first is flashed unless another is requested."""
    stock: frozenset[int]
    """Those numbers of encoders with which the firmware is as published."""
    make: Callable[[Mega, int, int], Sketch]
    auto_stop: int | None = None
    """ms without a command until it stops; None: it runs on."""


FIRMWARES: Final[Mapping[str, Firmware]] = MappingProxyType(
    {
        "mw": Firmware(
            "MWProtocol",
            mw.BAUD,
            (2, 3),
            frozenset({2}),
            lambda mega, encoders, _: MwSketch(mega, encoders=encoders),
        ),
        "ros-arduino-bridge": Firmware(
            "ros_arduino_bridge",
            ros_arduino_bridge.BAUD,
            (3, 2),
            frozenset({2}),
            RosSketch,
            AUTO_STOP,
        ),
        "arduinoio": Firmware(
            "ArduinoIO",
            arduinoio.BAUD,
            (2, 3),
            frozenset({2}),
            lambda mega, encoders, _: ArduinoIoSketch(mega, encoders),
        ),
        "firmata": Firmware(
            "Firmata",
            firmata.BAUD,
            (0, 2),
            frozenset({0, 2}),
            lambda mega, encoders, _: FirmataSketch(mega, encoders=encoders > 0),
        ),
    }
)


class Board:
    """A board as a node on the link "serial", its USB. The first call of `wake` is power-on."""

    def __init__(
        self,
        firmware: Firmware,
        load: MotorLoad,
        *,
        encoders: int | None = None,
        auto_stop: int | None = None,
        supply: float = SUPPLY_V,
        wiring: tuple[tuple[int, int], ...] = ENCODER_PINS,
    ) -> None:
        """Flash a firmware and put a load on the shield; `auto_stop` in ms, `supply` of the motors in V.

        `wiring` has the two pins at which each motor's encoder is.
        """
        count = firmware.encoders[0] if encoders is None else encoders
        stop = auto_stop if auto_stop is not None else firmware.auto_stop or 0
        shield = MotorShield()
        self.motors: Final = Motors(shield, load, wiring, supply=supply)
        self.mega: Final = Mega(
            lambda mega: firmware.make(mega, count, stop),
            firmware.baud,
            shield,
            shafts=self.motors,
        )
        self._usb: Final = UsbBoard(self.mega)

    def reset(self, now: Nanoseconds) -> None:
        """Reset the board by its button."""
        self._usb.reset(now)

    def hang(self, now: Nanoseconds) -> None:
        """Let its firmware do nothing more; its shield goes on as commanded."""
        self._usb.hang(now)

    def unpower(self, now: Nanoseconds, *, off: bool) -> None:
        """Take the 5 V of processor and shield, or give them back: both begin again."""
        self.mega.brown_out(now, low=off)
        # The shield's logic has the same 5 V: its registers are lost, and the motors are free.
        self.mega.shield.chip.power_on()

    def advance(self, now: Nanoseconds) -> None:
        """Advance to `now`, for observers of shield and motors; bytes that the board sends stay queued."""
        self._usb.advance(now)
        self.motors.advance(now)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a chunk from the host, or what became of DTR."""
        return self._moved(self._usb.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the board on."""
        return self._moved(self._usb.wake(now), now)

    def _moved(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        self.motors.advance(now)
        return Reaction(reaction.sent, min(reaction.wake_at, now + MOVES_EVERY))
