"""A helm, its pedals and buttons, as the kernel reports them: linux/joystick.h, `struct js_event`.

Eight bytes an event, little endian on every machine that this runs on: time in ms (4), value (2), kind (1)
and number (1). All states come once when the device is opened.
"""

import re
import struct
from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, NamedTuple

EVENT: Final = struct.Struct("<IhBB")
BUTTON: Final = 0x01
AXIS: Final = 0x02
AT_OPENING: Final = 0x80
FULL: Final = 32767


PLAY: Final = 0.05
"""Share of an axis's way that is no deflection."""


class At(NamedTuple):
    """An axis, with its value at rest."""

    number: int
    rest: int


@dataclass(frozen=True, slots=True)
class Device:
    """Assignment of a device's axes and buttons."""

    title: str
    helm: At
    """Right is positive."""
    accelerator: At
    """A pedal, or a trigger: its rest is at one end, and it is trodden down at the other."""
    brake: At
    rise: At
    """Negative at its upper end, as hats are: up and down."""
    reverse: int
    """A button, as the others."""
    arm: int
    stop: int
    switches: tuple[int, ...]
    """In the order of the robot's switches."""


DEVICES: Final[MappingProxyType[str, Device]] = MappingProxyType(
    {
        "pedals": Device(
            "helm and two pedals", At(0, 0), At(2, FULL), At(3, FULL), At(5, 0), 0, 1, 2, (4, 5, 6)
        ),
        "gamepad": Device(
            "gamepad: left stick, two triggers",
            At(0, 0),
            At(5, -FULL),
            At(2, -FULL),
            At(7, 0),
            0,
            7,
            1,
            (2, 3, 4),
        ),
    }
)
"""Assumed: as the kernel's drivers hid-lg (Logitech G29) and xpad number them; others may differ."""
USUAL: Final = "pedals"
_PADS: Final = re.compile(
    r"pad\b|x-?box|dual ?(shock|sense)|joy-?con|pro controller|wireless controller", re.IGNORECASE
)
_SECOND_STICK: Final = frozenset({0x03, 0x04})
"""ABS_RX and ABS_RY, linux/input-event-codes.h."""


def is_gamepad(name: str, codes: Collection[int]) -> bool:
    """Return whether a device is a gamepad by its name, or by the codes of its axes."""
    return _PADS.search(name) is not None or _SECOND_STICK.issubset(codes)


class Controls:
    """State of all controls of one device."""

    def __init__(self, device: Device) -> None:
        self.device: Final = device
        self._axes: Final[dict[int, int]] = {}
        self._down: Final[set[int]] = set()
        self._rest = b""

    def received(self, chunk: bytes) -> Iterator[int]:
        """Take bytes, cut anywhere; yield the buttons that go down, each before what comes after it."""
        whole = self._rest + chunk
        # An event may be cut between two reads.
        end = len(whole) - len(whole) % EVENT.size
        self._rest = whole[end:]
        for _, value, kind, number in EVENT.iter_unpack(whole[:end]):
            # The states at the opening count for axes, but a button that was down then was not pressed now.
            if kind & ~AT_OPENING == AXIS:
                self._axes[number] = value
            elif kind == BUTTON and value:
                self._down.add(number)
                yield number
            elif kind & ~AT_OPENING == BUTTON:
                self._down.discard(number)

    def held(self, button: int) -> bool:
        """Return whether a button is down; one that was when the device was opened is not."""
        return button in self._down

    @property
    def up(self) -> float:
        """From -1, down, to 1, up."""
        return -self._off(self.device.rise) / FULL

    @property
    def helm(self) -> float:
        """From -1, full right, to 1, full left."""
        return -self._off(self.device.helm) / FULL

    @property
    def accelerator(self) -> float:
        """From 0 to 1."""
        return abs(self._off(self.device.accelerator)) / (2 * FULL)

    @property
    def brake(self) -> float:
        """From 0 to 1."""
        return abs(self._off(self.device.brake)) / (2 * FULL)

    @property
    def resting(self) -> Mapping[str, bool]:
        """The controls at neutral, by their names here; one without a report yet is not."""
        device = self.device
        axes = {"up": device.rise, "helm": device.helm, "accelerator": device.accelerator}
        return {
            name: at.number in self._axes and abs(getattr(self, name)) < PLAY for name, at in axes.items()
        }

    def _off(self, at: At) -> int:
        """Return how far an axis is off its rest."""
        # -32768 is possible and would be more than full deflection.
        return max(-FULL, self._axes.get(at.number, at.rest)) - at.rest
