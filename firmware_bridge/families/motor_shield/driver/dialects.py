"""The bridge's commands to a board, protocol by protocol: find, set up, query, drive, release.

The time of a command and the set-point of a motor are not known here.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink, ShieldProtocol
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, motor_shield, mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.families.motor_shield.wire.motor_shield import Pin
from firmware_bridge.wire.lines import LineReader

FORWARD, BACKWARD = 1, 2
SHIELD: Final = 0
FREQUENCY: Final = 1_600
BUS_WRITE_US: Final = 550
"""One write of a channel on I2C at 100 kHz: six bytes of nine bits."""
CHANNELS: Final = 3
"""Written for a motor's speed and direction."""

Numbers: TypeAlias = tuple[int, ...]
Reads: TypeAlias = Callable[[Any], Numbers | None]


@dataclass(frozen=True, slots=True)
class BoardMessage:
    """One command, and what reads its answer: its numbers, or None for what answers something else."""

    what: str
    data: bytes
    reads: Reads | None = None
    """None: nothing answers."""
    answer: int = 0
    """Size in bytes of its longest answer."""
    writes: int = 0
    """Number of the board's writes to the shield for it."""
    counts: Numbers = ()
    """The motors whose counts the answer's numbers are, in their order."""
    wanted: Numbers | None = None
    """The numbers that have to come; None for any."""


class Dialect(ABC):
    """One protocol, for one board and its motors."""

    on_board = False
    """True where the speed loop is on the board: `drive` takes ticks a frame, else PWM of 255."""
    bits = 32
    """Of its counters."""
    begins = b""
    """The banner that the firmware sends when it has begun again, and else never; empty: none."""

    def __init__(self, link: ShieldLink, motors: Sequence[ShieldAxis]) -> None:
        self.link: Final = link
        self.motors: Final = tuple(motors)
        self.counted: Final = tuple(motor for motor in self.motors[: link.counted])
        """Those whose encoders are read."""

    @abstractmethod
    def reader(self) -> Any:
        """Return what reads the board's bytes from now on."""

    @abstractmethod
    def find(self) -> BoardMessage:
        """Return what any board with this firmware answers."""

    @abstractmethod
    def set_up(self) -> Iterator[BoardMessage]:
        """Yield what makes the board ready; what may turn is released first."""

    @abstractmethod
    def encoders(self) -> Iterator[BoardMessage]:
        """Yield the requests for all counts."""

    @abstractmethod
    def drive(self, wanted: Mapping[int, int], directions: Mapping[int, int]) -> Iterator[BoardMessage]:
        """Yield the commands that drive motors, by number, with a sign; `directions` are their present ones.

        It is 1 or -1, and 0 where the motor is released; it changes only where a motor is commanded to 0.
        """

    @abstractmethod
    def release(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Yield the commands that disable motors' power."""

    def release_again(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Yield the commands that disable the motors' power at a board that may have lost its set-up."""
        return self.release(motors)


class Ros(Dialect):
    """ros_arduino_bridge with a third motor."""

    on_board = True

    @property
    def _ports(self) -> Numbers:
        """The terminals of which the firmware has a motor each, used or not."""
        return tuple(range(1, max(*(motor.port for motor in self.motors), self.link.counted) + 1))

    def reader(self) -> LineReader:
        """Return what finds lines."""
        return LineReader()

    def _say(self, what: str, letter: str, numbers: Numbers = (), **more: Any) -> BoardMessage:
        count = len(self._ports)
        line = ros.encode(letter, numbers, count)
        return BoardMessage(what, line, lambda answer: ros.decode(letter, answer, count), **more)

    def find(self) -> BoardMessage:
        """Ask for the rate."""
        return self._say("who is there", "b", answer=7, wanted=(ros.BAUD,))

    def set_up(self) -> Iterator[BoardMessage]:
        """Release, give the gains, count from 0."""
        gains = self.link.gains
        yield from self.release(())
        yield self._say("gains", "u", (gains.kp, gains.kd, gains.ki, gains.ko), answer=4)
        yield self._say("count from 0", "r", answer=4)

    def encoders(self) -> Iterator[BoardMessage]:
        """Ask for all counts at once."""
        numbers = self._ports
        yield self._say("counts", "e", answer=12 * len(numbers) + 1, counts=numbers)

    def drive(self, wanted: Mapping[int, int], _directions: Mapping[int, int]) -> Iterator[BoardMessage]:
        """Send all speeds, also unchanged ones: the board stops when it receives nothing."""
        speeds = tuple(wanted.get(port, 0) for port in self._ports)
        return iter((self._say("speeds", "m", speeds, answer=4, writes=CHANNELS * len(speeds)),))

    def release(self, _motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Send speed 0, which releases all motors."""
        return self.drive(dict.fromkeys((motor.port for motor in self.motors), 0), {})


class ArduinoIo(Dialect):
    """ArduinoIO, sketch motor_v2."""

    bits = 16

    def reader(self) -> LineReader:
        """Return what finds lines: they end as those of ros_arduino_bridge do."""
        return LineReader()

    def _ask(self, what: str, letter: str, *values: int, **more: Any) -> BoardMessage:
        def reads(answer: bytes) -> Numbers | None:
            number = arduinoio.decode(answer)
            return None if number is None else (number,)

        return BoardMessage(what, arduinoio.encode(letter, *values), reads, **more)

    def find(self) -> BoardMessage:
        """Ask which sketch it is."""
        return self._ask("who is there", "9", 9, answer=3, wanted=(arduinoio.MOTOR_V2,))

    def set_up(self) -> Iterator[BoardMessage]:
        """Release, attach the encoders, count from 0."""
        yield from self.release(motor.port for motor in self.motors)
        for place, motor in enumerate(self.counted):
            yield BoardMessage("encoder", arduinoio.encode("E", place, *motor.encoder_pins))
            yield BoardMessage("count from 0", arduinoio.encode("H", place))
        # The commands before have no answer of their own; this one proves that they arrived.
        yield self.find()

    def encoders(self) -> Iterator[BoardMessage]:
        """Ask one after the other."""
        for place, motor in enumerate(self.counted):
            yield self._ask(f"count of M{motor.port}", "G", place, answer=8, counts=(motor.port,))

    def drive(self, wanted: Mapping[int, int], directions: Mapping[int, int]) -> Iterator[BoardMessage]:
        """Set the speed, and the direction where that changes."""
        for number, pwm in wanted.items():
            direction = _direction(pwm, directions[number])
            if direction != directions[number]:
                letter = ord("f" if direction > 0 else "b")
                yield BoardMessage(f"direction of M{number}", arduinoio.encode("B", number, letter), writes=2)
            yield BoardMessage(f"PWM of M{number}", arduinoio.encode("A", number, abs(pwm)), writes=1)

    def release(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Set speed 0, and release."""
        for number in motors:
            yield BoardMessage(f"PWM 0 of M{number}", arduinoio.encode("A", number, 0), writes=1)
            yield BoardMessage(f"release of M{number}", arduinoio.encode("B", number, ord("r")), writes=2)


def _direction(pwm: int, before: int) -> int:
    """Return the direction that a motor is to be set to, where it was set to another one, or released."""
    # At PWM 0 the direction stays as it was, so that a standing motor is not switched to and fro.
    return (pwm > 0) - (pwm < 0) or before or 1


class Mw(Dialect):
    """MWProtocol with motor shield and rotary encoders."""

    begins = mw.BANNER

    def __init__(self, link: ShieldLink, motors: Sequence[ShieldAxis]) -> None:
        super().__init__(link, motors)
        self._libraries: tuple[str, ...] = mw.LIBRARIES
        self._sequence = 0

    def reader(self) -> mw.AnswerReader:
        """Return what finds answers."""
        return mw.AnswerReader()

    def _ask(self, what: str, request: Any, **more: Any) -> BoardMessage:
        def reads(answered: mw.MwAnswer | mw.Traced) -> Numbers | None:
            decoded = mw.decode_answer(request, answered) if isinstance(answered, mw.MwAnswer) else None
            if isinstance(decoded, messages.ServerInfo):
                names = tuple(name.decode("ascii", "replace") for name in decoded.libraries)
                missing = {mw.SHIELD, mw.ENCODER} - set(names)
                self._libraries = self._libraries if missing else names
                return (int(not missing),)
            if isinstance(decoded, messages.Count):
                return (decoded.count,)
            return None if decoded is None else ()

        # Seven bits: the eighth marks a library's command.
        self._sequence = (self._sequence + 1) % mw.SEQUENCES
        frame = mw.encode_request(request, self._sequence, self._libraries)
        return BoardMessage(what, frame, reads, **{"answer": 6, **more})

    def find(self) -> BoardMessage:
        """Ask for the libraries."""
        return self._ask("who is there", messages.GetServerInfo(), answer=120, wanted=(1,))

    def set_up(self) -> Iterator[BoardMessage]:
        """Make shield and motors, release, attach the encoders, count from 0."""
        yield from self._made(tuple(motor.port for motor in self.motors))
        for place, motor in enumerate(self.counted):
            yield self._ask("encoder", messages.AttachEncoder(place, *motor.encoder_pins))
            yield self._ask("count from 0", messages.WriteCount(place, 0))

    def encoders(self) -> Iterator[BoardMessage]:
        """Ask one after the other."""
        for place, motor in enumerate(self.counted):
            what, request = f"count of M{motor.port}", messages.ReadCount(place, 0)
            yield self._ask(what, request, answer=15, counts=(motor.port,))

    def drive(self, wanted: Mapping[int, int], directions: Mapping[int, int]) -> Iterator[BoardMessage]:
        """Set speed and direction."""
        for number, pwm in wanted.items():
            # Speed and direction go in one command, so that no mixture of old and new is in force.
            turn = FORWARD if _direction(pwm, directions[number]) > 0 else BACKWARD
            request = messages.SetMotorSpeed(SHIELD, number - 1, abs(pwm), turn)
            yield self._ask(f"speed of M{number}", request, writes=CHANNELS)

    def release(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Stop, which is the library's name for release."""
        for number in motors:
            request = messages.StopMotor(SHIELD, number - 1)
            yield self._ask(f"release of M{number}", request, writes=2)

    def release_again(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Release what is made still, then make shield and motors, and release again; wait for no answer."""
        numbers = tuple(motors)
        for command in (*self.release(numbers), *self._made(numbers)):
            lasts = mw.SHIELD_TAKES_MS if command.writes > CHANNELS else mw.MOTOR_TAKES_MS
            yield BoardMessage(
                command.what,
                mw.apart(command.data, line_rate=self.link.rate, milliseconds=lasts),
                writes=command.writes,
            )

    def _made(self, numbers: tuple[int, ...]) -> Iterator[BoardMessage]:
        """Make shield and motors: what was not made takes nothing, and is answered all the same."""
        shield = messages.CreateShield(SHIELD, motor_shield.ADDRESS, FREQUENCY)
        yield self._ask("shield", shield, writes=21)
        for number in numbers:
            yield self._ask(f"M{number}", messages.CreateMotor(SHIELD, number - 1))
        yield from self.release(numbers)


class Firmata(Dialect):
    """ConfigurableFirmata: the shield's chip by I2C, two encoders."""

    begins = bytes((firmata.VERSION,))

    def reader(self) -> firmata.Parser:
        """Return what finds messages."""
        return firmata.Parser(from_board=True)

    def find(self) -> BoardMessage:
        """Ask for the firmware's name."""

        def reads(message: firmata.Message) -> Numbers | None:
            return () if message.exclusive and message.code == firmata.FIRMWARE and message.data else None

        return BoardMessage("who is there", firmata.exclusive(firmata.FIRMWARE), reads, answer=60)

    def set_up(self) -> Iterator[BoardMessage]:
        """Wake the chip, release, attach the encoders, count from 0."""
        yield self._bus()
        for data in motor_shield.SET_UP:
            yield BoardMessage("shield", firmata.i2c_write(motor_shield.ADDRESS, data), writes=1)
        yield from self.release(motor.port for motor in self.motors)
        for place, motor in enumerate(self.counted):
            for words in (bytes((0, place, *motor.encoder_pins)), bytes((3, place))):
                yield BoardMessage("encoder", firmata.exclusive(firmata.ENCODER, words))
        yield self.find()

    def encoders(self) -> Iterator[BoardMessage]:
        """Ask one after the other."""
        for place, motor in enumerate(self.counted):
            yield BoardMessage(
                f"count of M{motor.port}",
                firmata.exclusive(firmata.ENCODER, bytes((1, place))),
                lambda message, place=place: _count(message, place),  # type: ignore[misc] # bound now
                answer=8,
                counts=(motor.port,),
            )

    def drive(self, wanted: Mapping[int, int], directions: Mapping[int, int]) -> Iterator[BoardMessage]:
        """Set the speed, and the direction where that changes."""
        for number, pwm in wanted.items():
            direction = _direction(pwm, directions[number])
            if direction != directions[number]:
                low, high = (Pin.IN2, Pin.IN1) if direction > 0 else (Pin.IN1, Pin.IN2)
                # Low before high: both inputs high would brake for the time of a write.
                yield _channel(number, low, 0)
                yield _channel(number, high, 1)
            yield _channel(number, Pin.PWM, abs(pwm))

    def release(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Set all three inputs low."""
        for number in motors:
            for pin in Pin:
                yield _channel(number, pin, 0)

    def release_again(self, motors: Iterable[int]) -> Iterator[BoardMessage]:
        """Open the I2C bus first: a stray FF resets the firmware, which takes no I2C then."""
        yield self._bus()
        yield from self.release(motors)

    @staticmethod
    def _bus() -> BoardMessage:
        return BoardMessage("I2C", firmata.exclusive(firmata.I2C_CONFIG, bytes(2)))


def _channel(motor: int, pin: Pin, level: int) -> BoardMessage:
    data = firmata.i2c_write(motor_shield.ADDRESS, motor_shield.encode_channel(motor, pin, level))
    return BoardMessage(f"{pin.value} of M{motor}", data, writes=1)


def _count(message: firmata.Message, place: int) -> Numbers | None:
    """Return an encoder's count from its report; None for anything else."""
    counts = firmata.decode_counts(message)
    return (counts[0].count,) if len(counts) == 1 and counts[0].encoder == place else None


DIALECTS: Final[Mapping[ShieldProtocol, type[Dialect]]] = MappingProxyType(
    {
        ShieldProtocol.ROS_ARDUINO_BRIDGE: Ros,
        ShieldProtocol.ARDUINOIO: ArduinoIo,
        ShieldProtocol.MW: Mw,
        ShieldProtocol.FIRMATA: Firmata,
    }
)
