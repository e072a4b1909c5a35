"""What can be wrong with a board, by name, from one time to another: a row each.

Sources: ATmega2560 data sheet: brown-out holds the processor in reset; the
shield's chip goes on down to 2.3 V.
"""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

from emulators.arduino_omni.board import Board
from emulators.arduino_omni.mega.pins import ENCODER_PINS
from emulators.arduino_omni.shield.motor_shield import PORTS
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, SECOND, Nanoseconds


@dataclass(frozen=True, slots=True)
class BoardFault:
    """One kind: what it is called, what it is, and what puts it on, or takes it off again."""

    name: str
    what: str
    put: Callable[[Board, bool, Nanoseconds], None]


def _limit(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001 - rows have it so
    board.motors.faults.limits_current = on


def _heat(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
    board.motors.follow_heat(followed=on)


def _brown_out(board: Board, on: bool, now: Nanoseconds) -> None:  # noqa: FBT001
    board.mega.brown_out(now, low=on)


def _hang(board: Board, on: bool, now: Nanoseconds) -> None:  # noqa: FBT001
    if on:
        board.hang(now)
    else:
        board.reset(now)


def _unpowered(board: Board, on: bool, now: Nanoseconds) -> None:  # noqa: FBT001
    board.mega.brown_out(now, low=on)
    board.mega.shield.chip.power_on()


def _stuck(board: Board, on: bool, now: Nanoseconds) -> None:  # noqa: FBT001
    board.mega.jam_bus(now, stuck=on)


def _absent(board: Board, on: bool, now: Nanoseconds) -> None:  # noqa: FBT001
    board.advance(now)
    board.mega.jam_bus(now, stuck=on)
    board.mega.shield.chip.power_on()


def _swapped(motor: int) -> Callable[[Board, bool, Nanoseconds], None]:
    def put(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
        _in(board.motors.faults.swapped, motor, on=on)

    return put


def _reversed(motor: int) -> Callable[[Board, bool, Nanoseconds], None]:
    def put(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
        _in(board.motors.faults.reversed, motor, on=on)

    return put


def _cable(motor: int) -> Callable[[Board, bool, Nanoseconds], None]:
    def put(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
        _in(board.motors.faults.cut, motor, on=on)

    return put


def _encoder(motor: int) -> Callable[[Board, bool, Nanoseconds], None]:
    def put(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
        _in(board.motors.faults.dead, motor, on=on)

    return put


def _blocked(motor: int) -> Callable[[Board, bool, Nanoseconds], None]:
    def put(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
        board.motors.block(motor, blocked=on)

    return put


def _lifted(motor: int) -> Callable[[Board, bool, Nanoseconds], None]:
    def put(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
        board.motors.hoist(motor, lifted=on)

    return put


def _sag(board: Board, on: bool, _: Nanoseconds) -> None:  # noqa: FBT001
    board.motors.starves(SAGGED_V if on else math.inf)


def _in(places: set[int], place: int, *, on: bool) -> None:
    if on:
        places.add(place)
    else:
        places.discard(place)


SAGGED_V: Final = 2.0
"""Below what the half bridges need."""
ROWS: Final[tuple[BoardFault, ...]] = (
    BoardFault("current-limit", "a half bridge cuts a current that reaches 3.2 A", _limit),
    BoardFault("over-temperature", "the half bridges warm up, and shut down at 175 degrees C", _heat),
    BoardFault("hangs", "the firmware does nothing more until a reset; the shield goes on as told", _hang),
    BoardFault("brown-out", "the processor is held in reset; the shield goes on as it was told", _brown_out),
    BoardFault("shield-absent", "no shield is on the board: the sketch hangs in AFMS.begin()", _absent),
    BoardFault(
        "i2c-stuck", "the I2C bus is stuck: the sketch hangs, the shield goes on as it was set", _stuck
    ),
    BoardFault("unpowered", "processor and shield lose their 5 V, and begin anew", _unpowered),
    BoardFault("supply-sag", f"the motors' supply sags to {SAGGED_V:g} V: the half bridges are off", _sag),
    *(
        BoardFault(f"cable-{motor + 1}", f"the cable of the motor at {port.name} is off", _cable(motor))
        for motor, port in enumerate(PORTS)
    ),
    *(
        BoardFault(
            f"blocked-{motor + 1}", f"the shaft of the motor at {port.name} is blocked", _blocked(motor)
        )
        for motor, port in enumerate(PORTS)
    ),
    *(
        BoardFault(
            f"lifted-{motor + 1}", f"what the motor at {port.name} turns is in the air", _lifted(motor)
        )
        for motor, port in enumerate(PORTS)
    ),
    *(
        BoardFault(
            f"leads-{motor + 1}", f"the leads of the motor at {port.name} are exchanged", _reversed(motor)
        )
        for motor, port in enumerate(PORTS)
    ),
    *(
        BoardFault(
            f"channels-{motor + 1}",
            f"the channels of the encoder at M{motor + 1} are exchanged",
            _swapped(motor),
        )
        for motor in range(len(ENCODER_PINS))
    ),
    *(
        BoardFault(
            f"encoder-{motor + 1}", f"the encoder of the motor at M{motor + 1} is dead", _encoder(motor)
        )
        for motor in range(len(ENCODER_PINS))
    ),
)
FAULTS: Final[Mapping[str, BoardFault]] = MappingProxyType({row.name: row for row in ROWS})


@dataclass(frozen=True, slots=True)
class Planned:
    """A fault and its time, since power-on."""

    fault: BoardFault
    begins: Nanoseconds = 0
    ends: Nanoseconds = NEVER


def planned(text: str) -> Planned:
    """Read NAME, NAME@FROM or NAME@FROM-TO, times in s; ValueError that says what is wrong."""
    name, _, times = text.partition("@")
    if name not in FAULTS:
        raise ValueError(f"{text}: there is no such fault; there are: {', '.join(FAULTS)}")
    if not times:
        return Planned(FAULTS[name])
    begin, _, end = times.partition("-")
    try:
        begins = round(float(begin) * SECOND)
        ends = round(float(end) * SECOND) if end else NEVER
    except (ValueError, OverflowError):
        raise ValueError(f"{text}: '{times}' is no time; write {name}@5, or {name}@5-7.5, in s") from None
    if not 0 <= begins < ends:
        raise ValueError(f"{text}: it ends before it begins")
    return Planned(FAULTS[name], begins, ends)


class FaultyBoard:
    """A board as a node, on which what is planned goes wrong at its time."""

    def __init__(self, board: Board, plan: Iterable[Planned]) -> None:
        self.board: Final = board
        plan = tuple(plan)
        changes = [(it.begins, True, it.fault) for it in plan] + [
            (it.ends, False, it.fault) for it in plan if it.ends != NEVER
        ]
        self._changes: Final = sorted(changes, key=lambda it: it[0], reverse=True)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a chunk from the host, or what became of DTR."""
        sent = self._brought_to(now)
        return self._with(sent, self.board.receive(packet, now))

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the board on."""
        sent = self._brought_to(now)
        return self._with(sent, self.board.wake(now))

    def _brought_to(self, now: Nanoseconds) -> tuple[Packet, ...]:
        sent: tuple[Packet, ...] = ()
        while self._changes and self._changes[-1][0] <= now:
            at, on, fault = self._changes.pop()
            sent += self.board.wake(at).sent
            fault.put(self.board, on, at)
        return sent

    def _with(self, sent: tuple[Packet, ...], reaction: Reaction) -> Reaction:
        due = self._changes[-1][0] if self._changes else NEVER
        return Reaction(sent + reaction.sent, min(reaction.wake_at, due))
