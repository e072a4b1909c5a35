"""The sketch's binary in simavr and the emulator, side by side: the same things happen to both.

Bytes on serial and transfers on I2C are compared after each thing that happens. Time and edges are given, so
that neither clock matters: see harness.c.
"""

import subprocess
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Final, Self

from emulators.arduino_omni.mega.clock import Clock
from emulators.arduino_omni.mega.mega import Mega
from emulators.arduino_omni.mega.pins import ENCODER_PINS, FIRST_ANALOG, Shafts
from emulators.arduino_omni.sketches.ros_arduino_bridge import RosSketch
from emulators.arduino_omni.usb_board import UsbBoard
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

SKETCH: Final = Path(__file__).parents[3] / "emulators" / "arduino_omni" / "sketch"
HARNESS: Final = Path(__file__).with_name("harness.c")
AUTO_STOP: Final = 500
"""ms, of the sketch."""
REFERENCE_MV: Final = 5_000
LARGEST_READING: Final = 1_023


@dataclass(frozen=True)
class Bytes:
    """The host sends bytes."""

    data: bytes


@dataclass(frozen=True)
class Time:
    """New value of millis() from now on."""

    millis: int


@dataclass(frozen=True)
class Edges:
    """A wheel turns, by edges of its encoder."""

    wheel: int
    count: int


@dataclass(frozen=True)
class Level:
    """A pin is driven from outside."""

    pin: int
    high: bool


@dataclass(frozen=True)
class Voltage:
    """A voltage at an analog input; as a reading, 0 to 1023."""

    channel: int
    reading: int


Event = Bytes | Time | Edges | Level | Voltage


@dataclass(frozen=True)
class Received:
    """The result: bytes to the host, and transfers on the bus as harness.c writes them."""

    serial: bytes
    bus: str


def built(folder: Path, auto_stop: int = AUTO_STOP) -> tuple[Path, Path]:
    """Build harness and sketch; return both. CalledProcessError where a package is missing."""
    folder.mkdir(parents=True, exist_ok=True)
    harness = folder / "harness"
    compiled = ("gcc", "-O2", "-Wall", "-Wextra", "-Werror", "-o", harness, HARNESS, "-lsimavr", "-lelf")
    subprocess.run(compiled, check=True)
    flags = f"FLAGS=-DAUTO_STOP_MS={auto_stop}"
    words = ("make", "--quiet", "-C", str(SKETCH), f"BUILD={folder}", flags)
    subprocess.run(words, check=True)
    return harness, folder / "sketch.elf"


class Binary:
    """The true one; a context."""

    def __init__(self, harness: Path, sketch: Path) -> None:
        self._process: Final = subprocess.Popen(
            (harness, sketch), stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, bufsize=1
        )
        self.at_start: Final = self._received()

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.stdin.close()  # type: ignore[union-attr]
        self._process.stdout.close()  # type: ignore[union-attr]
        self._process.wait()

    def happens(self, event: Event) -> Received:
        """Let it happen; return what came of it."""
        match event:
            case Bytes(data):
                line = f"b {data.hex()}"
            case Time(millis):
                line = f"t {millis}"
            case Edges(wheel, count):
                line = f"e {wheel} {count}"
            case Level(pin, high):
                line = f"p {pin} {high:d}"
            case Voltage(channel, reading):
                millivolts = -(-reading * REFERENCE_MV // LARGEST_READING)
                line = f"a {FIRST_ANALOG + channel} {millivolts}"
        self._process.stdin.write(line + "\n")  # type: ignore[union-attr]
        return self._received()

    def _received(self) -> Received:
        line: str = self._process.stdout.readline()  # type: ignore[union-attr]
        if not line.endswith("\n"):
            raise RuntimeError("the harness has ended; it has printed why")
        stated, _, bus = line.rstrip("\n").partition(" ")
        return Received(bytes.fromhex(stated), bus)


class Given(Clock):
    """millis() as it is given."""

    def __init__(self) -> None:
        super().__init__(0)
        self.now = 0

    def millis(self, now: Nanoseconds) -> int:
        del now
        return self.now

    def shows(self, value: int, now: Nanoseconds) -> Nanoseconds:
        ahead = (value - self.now) % (1 << 32)
        return now if ahead == 0 or ahead >= 1 << 31 else NEVER


class Wheels(Shafts):
    """Wheels at given positions, with their levels on the pins."""

    def level(self, pin: int) -> bool | None:
        for wheel, pins in enumerate(ENCODER_PINS):
            if pin in pins:
                return (self.edges[wheel] - pins.index(pin)) % 4 in {1, 2}
        return None


@dataclass
class Tap:
    """A second chip at the shield's address that writes down what is on the bus."""

    text: list[str] = field(default_factory=list)
    hasty: bool = True
    _begun: bool = False

    def acknowledges(self, address: int, *, reading: bool) -> bool:
        del reading
        return address == 0x60

    def addressed(self, address: int, *, reading: bool, at: Nanoseconds) -> None:
        del at
        self.text.append(f"{'+' * self._begun}{address:02X}{'r' if reading else 'w'}")
        self._begun = True

    def written(self, byte: int, at: Nanoseconds) -> bool:
        del at
        self.text.append(f"{byte:02X}")
        return True

    def read(self, at: Nanoseconds) -> int:
        del at
        self.text.append("00")  # MODE1, after 0 was written to it: the one register that the sketch reads
        return 0xFF

    def stopped(self, at: Nanoseconds) -> None:
        del at
        self.text.append(",")
        self._begun = False


class Emulated:
    """The emulator's sketch, at rest after each thing that has happened."""

    def __init__(self) -> None:
        self._clock: Final = Given()
        self._tap: Final = Tap()
        self._mega: Final = Mega(self._flashed, ros.BAUD, shafts=Wheels(), others=(self._tap,))
        self._board: Final = UsbBoard(self._mega, flush=0)
        self._now: Nanoseconds = 0
        self._stated = bytearray()
        self.at_start: Final = self._rested(self._board.wake(0))

    def _flashed(self, mega: Mega) -> RosSketch:
        mega.clock = self._clock
        return RosSketch(mega, auto_stop=AUTO_STOP)

    def happens(self, event: Event) -> Received:
        """Let it happen; return what came of it."""
        self._now += SECOND
        match event:
            case Bytes(data):
                return self._rested(self._board.receive(Packet(SERIAL, 0, data), self._now))
            case Time(millis):
                self._clock.now = millis
                self._mega.clock = self._clock
            case Edges(wheel, count):
                self._mega.shafts.edges[wheel] += count
            case Level(pin, high):
                self._mega.pins.driven[pin] = high
            case Voltage(channel, reading):
                self._mega.pins.analog[channel] = reading
        return self._rested(self._board.wake(self._now))

    def _rested(self, reaction: Reaction) -> Received:
        while True:
            for packet in reaction.sent:
                self._stated += packet.payload
            if reaction.wake_at == NEVER:
                break
            self._now = max(self._now, reaction.wake_at)
            reaction = self._board.wake(self._now)
        received = Received(bytes(self._stated), "".join(self._tap.text))
        self._stated.clear()
        self._tap.text.clear()
        return received


def differences(binary: Binary, emulated: Emulated, events: Iterator[Event]) -> Iterator[str]:
    """Let it all happen to both; yield what was not the same, in words."""
    for number, event in enumerate(events):
        true, made = binary.happens(event), emulated.happens(event)
        if true != made:
            yield f"{number}, {event}:\n  binary   {true}\n  emulator {made}"
