"""A helm, its pedals and buttons, as the kernel tells them: linux/joystick.h, `struct js_event`.

Eight bytes an event, little endian on every machine that this runs on: time in ms (4), value (2), kind (1)
and number (1). All states come once when the device is opened.
"""

import struct
from collections.abc import Iterator
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

EVENT: Final = struct.Struct("<IhBB")
BUTTON: Final = 0x01
AXIS: Final = 0x02
AT_OPENING: Final = 0x80
FULL: Final = 32767


@dataclass(frozen=True, slots=True)
class Device:
    """Which axis and which button is what."""

    title: str
    helm: int
    """Its axis; right is positive."""
    accelerator: int
    brake: int
    released: int
    """What a pedal tells that nobody treads on: it is at the other end where it is trodden down."""
    reverse: int
    """A button, as the others."""
    arm: int
    stop: int
    switches: tuple[int, ...]
    """In the order of the robot's switches."""
    rise: int
    """An axis that is negative at its upper end, as hats are: up and down."""


DEVICES: Final[MappingProxyType[str, Device]] = MappingProxyType(
    {
        "pedals": Device("helm and two pedals", 0, 2, 3, FULL, 0, 1, 2, (4, 5, 6), 5),
        "gamepad": Device("gamepad: left stick, two triggers", 0, 5, 2, -FULL, 0, 7, 1, (2, 3, 4), 7),
    }
)
"""ASSUME: as the kernel's drivers hid-lg (Logitech G29) and xpad number them; others may number otherwise."""


class Controls:
    """Where everything of one device stands."""

    def __init__(self, device: Device) -> None:
        self.device: Final = device
        self._axes: Final[dict[int, int]] = {}
        self._down: Final[set[int]] = set()
        self._rest = b""

    def heard(self, chunk: bytes) -> Iterator[int]:
        """Take bytes, cut anywhere; yield the buttons that go down, each before what comes after it."""
        whole = self._rest + chunk
        end = len(whole) - len(whole) % EVENT.size
        self._rest = whole[end:]
        for _, value, kind, number in EVENT.iter_unpack(whole[:end]):
            if kind & ~AT_OPENING == AXIS:
                self._axes[number] = value
            elif kind == BUTTON and value:
                self._down.add(number)
                yield number
            elif kind & ~AT_OPENING == BUTTON:
                self._down.discard(number)

    def held(self, button: int) -> bool:
        """Tell whether a button is down; one that was when the device was opened is not."""
        return button in self._down

    @property
    def up(self) -> float:
        """From -1, down, to 1, up."""
        return -max(-FULL, self._axes.get(self.device.rise, 0)) / FULL

    @property
    def helm(self) -> float:
        """From -1, full right, to 1, full left."""
        return -max(-FULL, self._axes.get(self.device.helm, 0)) / FULL

    @property
    def accelerator(self) -> float:
        """From 0 to 1."""
        return self._pedal(self.device.accelerator)

    @property
    def brake(self) -> float:
        """From 0 to 1."""
        return self._pedal(self.device.brake)

    def _pedal(self, axis: int) -> float:
        released = self.device.released
        value = max(-FULL, self._axes.get(axis, released))
        return abs(value - released) / (2 * FULL)
