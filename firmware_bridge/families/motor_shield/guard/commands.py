"""The effect of one command to a board with a motor shield on its motors, protocol by protocol.

A packet is one command, whole. A command that is not listed here does not leave.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Final, NamedTuple, TypeAlias

from firmware_bridge.families.motor_shield.settings import ShieldLink, ShieldProtocol
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, motor_shield, mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.families.motor_shield.wire.motor_shield import Pin

FORWARD, BACKWARD = 1, 2


class Inputs(NamedTuple):
    """A half bridge's inputs; in a command None stays as it is."""

    size: int | None
    """PWM of 255; of a loop on the board ticks a frame."""
    in1: bool | None
    in2: bool | None


TURNS: Final[Mapping[int, tuple[bool, bool]]] = MappingProxyType(
    {FORWARD: (True, False), BACKWARD: (False, True)}
)


@dataclass(frozen=True, slots=True)
class ListedCommand:
    """One command that is listed."""

    drives: Mapping[int, Inputs] = field(default_factory=dict)
    """The inputs of the motors that it drives, by their numbers."""
    at_standstill: bool = False
    """Only while nothing moves: it changes what is counted, or how the motors are reached."""


class Board(NamedTuple):
    """The guard's model of the firmware: by the robot file, with the libraries that MWProtocol reports."""

    link: ShieldLink
    motors: tuple[int, ...]
    libraries: tuple[str, ...]

    @property
    def terminals(self) -> int:
        """Number of motors that ros_arduino_bridge is built for: it takes a word for each, used or not."""
        return max(*self.motors, self.link.counted)


Reader: TypeAlias = Callable[[bytes, Board], ListedCommand | None]
NOTHING: Final = ListedCommand()
AT_STANDSTILL: Final = ListedCommand(at_standstill=True)


def _signed(size: int) -> Inputs:
    return Inputs(abs(size), *TURNS[BACKWARD if size < 0 else FORWARD])


def _ros(data: bytes, board: Board) -> ListedCommand | None:
    text = data.removesuffix(ros.END).decode("ascii", "replace")
    letter, _, rest = text.partition(" ")
    gains = board.link.gains
    if letter in {"b", "e"} and data == ros.encode(letter):
        return NOTHING
    # Only the gains of the robot file: with others the loop on the board could become unstable.
    if data in {ros.encode("r"), ros.encode("u", (gains.kp, gains.kd, gains.ki, gains.ko))}:
        return AT_STANDSTILL
    words = rest.split(" ")
    if len(words) != board.terminals or not all(_is_number(word) for word in words):
        return None
    speeds = tuple(map(int, words))
    # Encoded again and compared: the sketch parses leniently, so another spelling may be another speed to it.
    if data != ros.encode("m", speeds, len(speeds)):
        return None
    if not any(speeds):
        return ListedCommand(dict.fromkeys(board.motors, Inputs(0, in1=False, in2=False)))
    drives = {port: _signed(speed) for port, speed in enumerate(speeds, start=1) if port in board.motors}
    # A motor that is no axis of the robot must not move: nothing reports it.
    unused = (speed for port, speed in enumerate(speeds, start=1) if port not in board.motors)
    return None if any(unused) else ListedCommand(drives)


def _is_number(word: str) -> bool:
    digits = word.removeprefix("-")
    return digits.isdigit() and len(digits) < ros.WORD - 1


def _arduinoio(data: bytes, board: Board) -> ListedCommand | None:
    row = arduinoio.COMMANDS.get(chr(data[0])) if data else None
    if row is None or len(data) != 1 + len(row.follows):
        return None
    if not all(kind.takes(byte) for kind, byte in zip(row.follows, data[1:], strict=True)):
        return None
    values = [byte - kind.base for kind, byte in zip(row.follows, data[1:], strict=True)]
    if row.letter in "9GX":
        return NOTHING
    if row.letter in "EH":
        return AT_STANDSTILL
    if row.letter == "A" and values[0] in board.motors:
        return ListedCommand({values[0]: Inputs(values[1], None, None)})
    turn = _RUNS.get(values[1]) if row.letter == "B" and values[0] in board.motors else None
    return None if turn is None else ListedCommand({values[0]: Inputs(None, *turn)})


_RUNS: Final = {ord("f"): TURNS[FORWARD], ord("b"): TURNS[BACKWARD], ord("r"): (False, False)}


def _mw(data: bytes, board: Board) -> ListedCommand | None:
    match _request(data, board):
        case messages.GetServerInfo() | messages.ReadCount(reset=0):
            return NOTHING
        case (
            messages.CreateShield()
            | messages.CreateMotor()
            | messages.AttachEncoder()
            | messages.WriteCount()
        ):
            return AT_STANDSTILL
        case messages.SetMotorSpeed(0, motor, speed, turn) if motor + 1 in board.motors and turn in TURNS:
            return ListedCommand({motor + 1: Inputs(speed, *TURNS[turn])})
        case messages.StopMotor(0, motor) if motor + 1 in board.motors:
            return ListedCommand({motor + 1: Inputs(None, in1=False, in2=False)})
        case _:
            return None


def _request(data: bytes, board: Board) -> object:
    """Return MWProtocol's request in one whole frame; None where there is none that is known."""
    counted = data[1:3]
    # Start byte, then the length in 16 bits, low byte first.
    size = 3 + int.from_bytes(counted, "little")
    requested = mw.decode_frame(counted, data[3:size]) if data[:1] == bytes((mw.HOST_START,)) else None
    if requested is None or len(data) < size or any(data[size:]):
        return None
    name = mw.CORE
    if requested.library is not None:
        name = board.libraries[requested.library] if requested.library < len(board.libraries) else "?"
    row = mw.COMMANDS.get((name, requested.code))
    return None if row is None or row.request is None else row.request.decode(requested.data)


def _firmata(data: bytes, board: Board) -> ListedCommand | None:
    found = list(firmata.Parser().receive(data))
    if len(found) != 1 or firmata.encode(found[0]) != data:
        return None
    message = found[0]
    if message.code == firmata.ENCODER and message.data:
        return {0: AT_STANDSTILL, 1: NOTHING, 2: NOTHING, 3: AT_STANDSTILL}.get(message.data[0])
    if message.code == firmata.I2C_REQUEST and message.data[:2] == bytes((motor_shield.ADDRESS, 0)):
        values = firmata.unpaired(message.data[2:])
        # Two bytes of 7 bits can carry more than the 8 of a register.
        return None if any(value > 0xFF for value in values) else _written(bytes(values), board)  # noqa: PLR2004
    if message.code == firmata.I2C_CONFIG:
        return AT_STANDSTILL
    return NOTHING if message in _QUERIES else None


_QUERIES: Final = (firmata.Message(firmata.FIRMWARE, b"", exclusive=True), firmata.Message(firmata.VERSION))


def _written(data: bytes, board: Board) -> ListedCommand | None:
    """Return what a write to the shield's chip means."""
    if data in motor_shield.SET_UP:
        return AT_STANDSTILL
    written = motor_shield.decode_channel(data)
    if written is None or written.motor not in board.motors:
        return None
    level = written.level
    inputs = {
        Pin.PWM: Inputs(level, None, None),
        Pin.IN1: Inputs(None, bool(level), None),
        Pin.IN2: Inputs(None, None, bool(level)),
    }
    return ListedCommand({written.motor: inputs[written.pin]})


READERS: Final[Mapping[ShieldProtocol, Reader]] = MappingProxyType(
    {
        ShieldProtocol.ROS_ARDUINO_BRIDGE: _ros,
        ShieldProtocol.ARDUINOIO: _arduinoio,
        ShieldProtocol.MW: _mw,
        ShieldProtocol.FIRMATA: _firmata,
    }
)


def no_motion(motor: int, board: Board) -> Iterator[bytes]:
    """Yield the commands that take a motor's speed: it brakes, or is released.

    Of a loop on the board the speeds of all motors are one command, and 0 for all of them releases them.
    """
    protocol = board.link.protocol
    if protocol is ShieldProtocol.ROS_ARDUINO_BRIDGE:
        yield ros.encode("m", (0,) * board.terminals, board.terminals)
    elif protocol is ShieldProtocol.ARDUINOIO:
        yield arduinoio.encode("A", motor, 0)
    elif protocol is ShieldProtocol.MW:
        if mw.SHIELD in board.libraries:
            frame = mw.encode_request(messages.StopMotor(0, motor - 1), 0, board.libraries)
            yield mw.apart(frame, line_rate=board.link.rate, milliseconds=mw.MOTOR_TAKES_MS)
    else:
        yield firmata.i2c_write(motor_shield.ADDRESS, motor_shield.encode_channel(motor, Pin.PWM, 0))


def libraries_in(answers: Iterator[mw.MwAnswer | mw.Traced]) -> tuple[str, ...] | None:
    """Return the libraries that MWProtocol's answers name; None where none does."""
    for answer in answers:
        answer_of = (
            mw.decode_answer(messages.GetServerInfo(), answer) if isinstance(answer, mw.MwAnswer) else None
        )
        if isinstance(answer_of, messages.ServerInfo):
            return tuple(name.decode("ascii", "replace") for name in answer_of.libraries)
    return None
