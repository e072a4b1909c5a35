"""The Mega 2560 as its processor is: a sketch that does one thing at a time, and no byte while it starts.

As a node it sits with its serial pins on the link "serial": bytes come and go in the time that the wire
gives them. On USB it sits behind a second chip: `emulators.arduino_omni.usb_board`.

Sources: ArduinoCore-avr, bootloaders/stk500v2: the loader waits for about 1 s. Whatever byte comes in that
time keeps it, until none has come for 8 million rounds of its loop; all of them are swallowed.

Where they are silent:
* from reset to setup it is 1.1 s; 8 million rounds are 9 s; no frame for the loader itself is answered.
* instructions take no time; what takes time is the I2C bus, a delay, 112 us for an analogRead, and a full
  transmit ring.
"""

from collections import deque
from collections.abc import Callable, Iterable
from typing import Final, Protocol

from emulators.arduino_omni.mega.clock import Clock
from emulators.arduino_omni.mega.jobs import Call, Delay, Job, OnBus, Say
from emulators.arduino_omni.mega.pins import Pins, Shafts
from emulators.arduino_omni.mega.uart import Uart
from emulators.arduino_omni.shield.i2c import Chip, I2cBus, TransferResult
from emulators.arduino_omni.shield.motor_shield import MotorShield
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, Nanoseconds, to_seconds

BOOT: Final[Nanoseconds] = 1_100 * MILLISECOND
KEPT: Final[Nanoseconds] = 9_000 * MILLISECOND
"""Time from the last byte that the boot loader received to the start of the sketch."""
CONVERSION: Final[Nanoseconds] = 112 * MICROSECOND
"""One analogRead."""
_NOT_REQUESTED: Final = -1
STEPS_AT_ONCE: Final = 10_000
"""Limit of actions at one instant. Full rings of commands give some hundreds, before they take time."""


class SketchError(Exception):
    """A sketch wants to be called for ever, and takes no time: time would stand still."""


class Sketch(Protocol):
    """A firmware, made again at each reset."""

    def setup(self) -> None:
        """Give the board its first jobs."""

    def loop(self, now: Nanoseconds) -> None:
        """Read what has arrived, and give the board jobs; they are done before the next call."""

    def due(self, now: Nanoseconds) -> Nanoseconds:
        """Return when to call `loop` though nothing has arrived, later than the last call; or NEVER."""


def _nothing() -> None:
    """Do nothing."""


class Mega:
    """One board with its shield."""

    def __init__(
        self,
        sketch: Callable[["Mega"], Sketch],
        baud: int,
        shield: MotorShield | None = None,
        *,
        shafts: Shafts | None = None,
        others: tuple[Chip, ...] = (),
        boot: Nanoseconds = BOOT,
    ) -> None:
        """Flash a sketch; `others` are further chips on the bus, `boot` is the loader's time.

        `shafts` are advanced to each instant at which the board does something.
        """
        self.shield: Final = MotorShield() if shield is None else shield
        self.shafts: Final = Shafts() if shafts is None else shafts
        self.pins: Final = Pins(self.shafts)
        self.serial: Final = Uart(baud)
        self.bus: Final = I2cBus((self.shield.chip, *others))
        self._clock = Clock(0)
        self.resets = 0
        """Times that it has started."""
        self._make: Final = sketch
        self._sketch: Sketch | None = None
        self._boot: Final = boot
        self.kept: Callable[[], None] = _nothing
        """Callback for each byte that keeps the boot loader."""
        self._starts_at: Nanoseconds = NEVER
        self._jobs: deque[Job] = deque()
        self._running: OnBus | None = None
        self._free_at: Nanoseconds = 0
        self._wakes_at: Nanoseconds = _NOT_REQUESTED
        """Next call requested by the sketch for when nothing arrives; read after it has done something."""
        self._powered = False
        self._held = False

    @property
    def baud(self) -> int:
        """Actual bit rate on its serial pins."""
        return self.serial.baud

    @property
    def sketch(self) -> Sketch | None:
        """The running sketch; None in the boot loader."""
        return self._sketch

    # For sketches

    def do(self, *jobs: Job) -> None:
        """Put jobs behind those that wait."""
        self._jobs.extend(jobs)

    def do_all(self, jobs: Iterable[Job]) -> None:
        """Put jobs behind those that wait."""
        self._jobs.extend(jobs)

    # For the world

    def reset(self, now: Nanoseconds) -> None:
        """Pull RESET: what is under way ends where it is. The shield has no wire to it, and runs on."""
        self.advance(now)
        self.bus.abandon(now)
        self.serial.reset(now)
        self.pins.reset()
        self._jobs.clear()
        self._running = None
        self._sketch = None
        self._free_at = now
        self._starts_at = NEVER if self._held else now + self._boot
        self._powered = True
        self.resets += 1

    def brown_out(self, now: Nanoseconds, *, low: bool) -> None:
        """Hold it in reset while the supply is too low, and start it again when it is back."""
        self._held = low
        self.reset(now)

    def hang(self, now: Nanoseconds) -> None:
        """Do nothing more until it is reset, as Wire does when the bus is stuck."""
        self.advance(now)
        self.bus.abandon(now)
        self._jobs.clear()
        self._running, self._free_at = None, NEVER

    @property
    def hung(self) -> bool:
        """True if the sketch waits for an event that never comes: only a reset of the board ends this."""
        waits = self._running is not None and self.bus.due == NEVER
        return self._sketch is not None and (waits or self._free_at == NEVER)

    def jam_bus(self, now: Nanoseconds, *, stuck: bool) -> None:
        """Let the I2C bus be stuck from here on, or free again: a sketch that waits for it waits on."""
        self.advance(now)
        self.bus.jam(now, stuck=stuck)

    def print(self, data: bytes, now: Nanoseconds) -> None:
        """Let the sketch print by itself, behind what it does now; one that starts, or hangs, does not."""
        self.advance(now)
        if self._sketch is not None and self._free_at != NEVER:
            self.do(Say(data))

    @property
    def clock(self) -> Clock:
        """The sketch's view of the time."""
        return self._clock

    @clock.setter
    def clock(self, clock: Clock) -> None:
        """Give it another one, or one that was set: what it waits for may come earlier by it."""
        self._clock = clock
        self._wakes_at = _NOT_REQUESTED

    def receive(self, byte: int, now: Nanoseconds) -> None:
        """Take a byte whose stop bit has passed."""
        self.advance(now)
        if self._sketch is not None:
            self.serial.arrived(byte)
            # The sketch may have been idle for long: it reads the byte now, not then.
            self._free_at = max(self._free_at, now)
            self.advance(now)
        elif self._powered and not self._held:
            # A host that sends too early keeps the loader for another 9 s: its board seems dead.
            self._starts_at = now + KEPT
            self.kept()

    @property
    def due(self) -> Nanoseconds:
        """Next time to call `advance`; in the past where the sketch has something to do at once."""
        if self._sketch is None:
            return self._starts_at
        if self._running is not None:
            return self.bus.due
        if self._jobs or self.serial.available:
            return self._free_at
        # Requested once for each idle time: `due` is read at every event of the world.
        if self._wakes_at == _NOT_REQUESTED:
            self._wakes_at = self._sketch.due(self._free_at)
        return max(self._free_at, self._wakes_at)

    def advance(self, now: Nanoseconds) -> None:
        """Do what is due by `now`, each thing at its own time; SketchError where that never ends."""
        begun, steps = -1, 0
        while (at := self.due) <= now:
            steps = steps + 1 if at <= begun else 0
            if steps > STEPS_AT_ONCE:
                sketch = type(self._sketch).__name__
                raise SketchError(
                    f"the sketch {sketch} does not get on at {to_seconds(at):.6f} s: {STEPS_AT_ONCE} steps"
                    " there, and it wants to go on; its `due` must be later than its last `loop`"
                )
            begun = max(begun, at)
            # The motors first: the sketch reads the counts of this instant.
            self.shafts.reach(at)
            # Whatever happens now may change when the sketch has to be called.
            self._wakes_at = _NOT_REQUESTED
            if self._sketch is None:
                self._start(at)
            elif self._running is not None:
                self._carry(self._running, at)
            elif self._jobs:
                self._begin(self._jobs.popleft(), at)
            else:
                self._loop(self._sketch, at)

    def _start(self, at: Nanoseconds) -> None:
        self._starts_at = NEVER
        self._free_at = at
        self.clock = Clock(at)
        self._sketch = self._make(self)
        self._sketch.setup()

    def _loop(self, sketch: Sketch, at: Nanoseconds) -> None:
        self._free_at = at
        sketch.loop(at)

    def _carry(self, job: OnBus, at: Nanoseconds) -> None:
        result = self.bus.advance(at)
        if result is not None:
            self._running = None
            self._free_at = at
            self._then(job, result, at)

    def _then(self, job: OnBus, result: TransferResult, at: Nanoseconds) -> None:
        """Let the sketch go on with what it has read: what it gives now comes before what waits."""
        if job.then is not None:
            waiting = list(self._jobs)
            self._jobs.clear()
            job.then(result, at)
            self._jobs.extend(waiting)

    def _begin(self, job: Job, at: Nanoseconds) -> None:
        if isinstance(job, OnBus):
            self._running = job
            self.bus.begin(job.transfer, at)
        elif isinstance(job, Delay):
            self._free_at = at + job.duration
        elif isinstance(job, Say):
            self._free_at = self.serial.write(job.data, at)
        else:
            self._call(job, at)

    def _call(self, job: Call, at: Nanoseconds) -> None:
        # As after a transfer: what the action requests comes before what waits already.
        waiting = list(self._jobs)
        self._jobs.clear()
        job.action(at)
        self._jobs.extend(waiting)


class MegaOnPins:
    """A Mega as a node whose serial pins are on a wire; the first call of `wake` is power-on."""

    def __init__(self, mega: Mega) -> None:
        self.mega: Final = mega
        self._powered = False

    @property
    def baud(self) -> int:
        """Actual bit rate."""
        return self.mega.baud

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take bytes that have wholly arrived."""
        for byte in packet.payload:
            self.mega.receive(byte, now)
        return self._reaction(now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the board on."""
        if not self._powered:
            self._powered = True
            self.mega.reset(now)
        self.mega.advance(now)
        return self._reaction(now)

    def _reaction(self, now: Nanoseconds) -> Reaction:
        # The wire spaces the bytes, at the board's own bit rate: all that was written may go.
        written = self.mega.serial.taken(NEVER)
        return Reaction((Packet(SERIAL, 0, written),) if written else (), max(now, self.mega.due))
