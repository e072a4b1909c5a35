"""Faults of a board in real time, by the names of a mission's faults: one row each.

Sources: ATmega2560 data sheet: brown-out holds the processor in reset; the shield's chip goes on down to 2.3
V.
"""

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final, TypeAlias

from emulators.arduino_omni.board import Board
from emulators.arduino_omni.mega.pins import ENCODER_PINS
from emulators.arduino_omni.shield.motor_shield import PORTS
from firmware_bridge.node import LINE_BACK, LINE_LOST, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot.problems import near
from firmware_bridge.units import NEVER, SECOND, Nanoseconds

SAGGED_V: Final = 2.0
"""Supply below the need of the half bridges."""
MOTORS: Final = tuple(port.name for port in PORTS)
ENCODERS: Final = MOTORS[: len(ENCODER_PINS)]


@dataclass(frozen=True, slots=True)
class Change:
    """A fault that begins, or ends, now."""

    board: Board
    on: bool
    now: Nanoseconds
    motor: int
    """Index of the motor, from 0."""


Put: TypeAlias = Callable[[Change], None]


@dataclass(frozen=True, slots=True)
class BoardFault:
    """One kind: what it is called, what it is, and what puts it on, or takes it off again."""

    name: str
    what: str
    put: Put
    nodes: tuple[str, ...] = ()
    """The motors of which it needs one; empty where it is the board's."""


def _limit(it: Change) -> None:
    it.board.motors.faults.limits_current = it.on


def _hang(it: Change) -> None:
    if it.on:
        it.board.hang(it.now)
    else:
        it.board.reset(it.now)


def _absent(it: Change) -> None:
    it.board.advance(it.now)
    it.board.mega.jam_bus(it.now, stuck=it.on)
    # A shield that is plugged in again has lost its registers.
    it.board.mega.shield.chip.power_on()


def _in(of: Callable[[Board], set[int]]) -> Put:
    def put(it: Change) -> None:
        if it.on:
            of(it.board).add(it.motor)
        else:
            of(it.board).discard(it.motor)

    return put


def _cut(_: Change) -> None:
    """Leave the board as it is: its line is gone, see `FaultyBoard`."""


UNPLUGGED: Final = BoardFault(
    "serial_unplugged",
    "the USB cable is out: the port is gone, and returns as its --serial-link; the sketch keeps running",
    _cut,
)
ROWS: Final[tuple[BoardFault, ...]] = (
    BoardFault("current_limit", "a half bridge cuts a current that reaches 3.2 A", _limit),
    BoardFault(
        "over_temperature",
        "the half bridges warm up, and shut down at 175 degrees C",
        lambda it: it.board.motors.follow_heat(followed=it.on),
    ),
    BoardFault("board_hangs", "the firmware hangs until a reset; the shield continues", _hang),
    BoardFault(
        "board_brown_out",
        "the processor is held in reset; the shield continues with its last command",
        lambda it: it.board.mega.brown_out(it.now, low=it.on),
    ),
    BoardFault(
        "board_reset",
        "the reset button is pressed",
        lambda it: it.board.reset(it.now) if it.on else None,
    ),
    UNPLUGGED,
    BoardFault("shield_absent", "no shield is on the board: the sketch hangs in AFMS.begin()", _absent),
    BoardFault(
        "i2c_stuck",
        "the I2C bus is stuck: the sketch hangs, the shield keeps its settings",
        lambda it: it.board.mega.jam_bus(it.now, stuck=it.on),
    ),
    BoardFault(
        "board_unpowered",
        "processor and shield lose their 5 V, and restart",
        lambda it: it.board.unpower(it.now, off=it.on),
    ),
    BoardFault(
        "motor_supply_sag",
        f"the motors' supply sags to {SAGGED_V:g} V: the half bridges are off",
        lambda it: it.board.motors.starves(SAGGED_V if it.on else math.inf),
    ),
    BoardFault(
        "motor_cable_off", "the cable of the motor is off", _in(lambda it: it.motors.faults.cut), MOTORS
    ),
    BoardFault(
        "shaft_blocked",
        "the motor's shaft is blocked",
        lambda it: it.board.motors.block(it.motor, blocked=it.on),
        MOTORS,
    ),
    BoardFault(
        "load_lifted",
        "the motor's load is off the floor",
        lambda it: it.board.motors.hoist(it.motor, lifted=it.on),
        MOTORS,
    ),
    BoardFault(
        "motor_leads_swapped",
        "the motor's leads are exchanged",
        _in(lambda it: it.motors.faults.reversed),
        MOTORS,
    ),
    BoardFault(
        "encoder_swapped",
        "the channels of the motor's encoder are exchanged",
        _in(lambda it: it.motors.faults.swapped),
        ENCODERS,
    ),
    BoardFault(
        "encoder_cable_off", "the motor's encoder fails", _in(lambda it: it.motors.faults.dead), ENCODERS
    ),
)
FAULTS: Final[Mapping[str, BoardFault]] = MappingProxyType({row.name: row for row in ROWS})
FORMER: Final[Mapping[str, str]] = MappingProxyType(
    {
        "current-limit": "current_limit",
        "over-temperature": "over_temperature",
        "hangs": "board_hangs",
        "brown-out": "board_brown_out",
        "shield-absent": "shield_absent",
        "i2c-stuck": "i2c_stuck",
        "unpowered": "board_unpowered",
        "supply-sag": "motor_supply_sag",
        "cable": "motor_cable_off",
        "blocked": "shaft_blocked",
        "lifted": "load_lifted",
        "leads": "motor_leads_swapped",
        "channels": "encoder_swapped",
        "encoder": "encoder_cable_off",
    }
)
"""Former names of the faults; the motor's number stood behind the name."""
_FORMER: Final = re.compile(rf"({'|'.join(FORMER)})(?:-([1-4]))?")


@dataclass(frozen=True, slots=True)
class Planned:
    """A fault, its motor from 0, and its time since power-on."""

    fault: BoardFault
    motor: int = 0
    begins: Nanoseconds = 0
    ends: Nanoseconds = NEVER
    instead: str = ""
    """Present spelling of the fault, where it was written in the former one."""


def planned(text: str) -> Planned:
    """Read KIND[,node=M1][@FROM[-TO]], times in s; raise ValueError with the reason if it cannot be read."""
    written, _, times = text.partition("@")
    instead = _renamed(written)
    name, *keys = (instead or written).split(",")
    fault = FAULTS.get(name)
    if fault is None:
        raise ValueError(f"{text}: there is no such fault; {near(name, FAULTS, most=len(FAULTS))}")
    motor = _motor(text, fault, keys)
    begins, ends = _times(text, instead or written, times) if times else (0, NEVER)
    return Planned(fault, motor, begins, ends, instead and text.replace(written, instead, 1))


def _renamed(written: str) -> str:
    """Return the present spelling of a fault in the former one; else an empty string."""
    found = _FORMER.fullmatch(written)
    if found is None:
        return ""
    name, number = FORMER[found[1]], found[2]
    return name if number is None else f"{name},node=M{number}"


def _motor(text: str, fault: BoardFault, keys: Iterable[str]) -> int:
    """Return the index of the motor, from 0; 0 where the fault is the board's."""
    written = dict(key.partition("=")[::2] for key in keys)
    known = ["node"] if fault.nodes else []
    for key in written:
        if key not in known:
            has = "node" if known else "none"
            raise ValueError(f"{text}: {fault.name} knows no key '{key}'; there is: {has}")
    if not fault.nodes:
        return 0
    choice = f"{', '.join(fault.nodes[:-1])} or {fault.nodes[-1]}"
    if not (node := written.get("node", "")):
        raise ValueError(f"{text}: {fault.name} needs node: {choice}")
    if node not in fault.nodes and f"M{node}" not in fault.nodes:
        raise ValueError(f"{text}: there is no node '{node}'; {fault.name} needs node: {choice}")
    return fault.nodes.index(node if node in fault.nodes else f"M{node}")


def _times(text: str, name: str, times: str) -> tuple[Nanoseconds, Nanoseconds]:
    begin, _, end = times.partition("-")
    try:
        begins = round(float(begin) * SECOND)
        ends = round(float(end) * SECOND) if end else NEVER
    except (ValueError, OverflowError):
        raise ValueError(f"{text}: '{times}' is no time; write {name}@5, or {name}@5-7.5, in s") from None
    if not 0 <= begins < ends:
        raise ValueError(f"{text}: it ends before it begins")
    return begins, ends


class FaultyBoard:
    """A board as a node, on which what is planned goes wrong at its time."""

    def __init__(self, board: Board, plan: Iterable[Planned]) -> None:
        self.board: Final = board
        plan = tuple(plan)
        changes = [(it.begins, True, it) for it in plan] + [
            (it.ends, False, it) for it in plan if it.ends != NEVER
        ]
        self._changes: Final = sorted(changes, key=lambda it: it[0], reverse=True)
        self._unplugged = False

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take a chunk from the host, or what became of DTR; nothing comes over a cable that is out."""
        sent = self._brought_to(now)
        return self._with(sent, self.board.wake(now) if self._unplugged else self.board.receive(packet, now))

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the board on."""
        sent = self._brought_to(now)
        return self._with(sent, self.board.wake(now))

    def _brought_to(self, now: Nanoseconds) -> tuple[Packet, ...]:
        sent: tuple[Packet, ...] = ()
        while self._changes and self._changes[-1][0] <= now:
            at, on, it = self._changes.pop()
            # Up to the fault's instant the board runs without it.
            sent += self._passed(self.board.wake(at).sent)
            it.fault.put(Change(self.board, on, at, it.motor))
            if it.fault is UNPLUGGED:
                self._unplugged = on
                sent += (Packet(SERIAL, LINE_LOST if on else LINE_BACK, b""),)
        return sent

    def _passed(self, sent: tuple[Packet, ...]) -> tuple[Packet, ...]:
        return () if self._unplugged else sent

    def _with(self, sent: tuple[Packet, ...], reaction: Reaction) -> Reaction:
        due = self._changes[-1][0] if self._changes else NEVER
        return Reaction(sent + self._passed(reaction.sent), min(reaction.wake_at, due))
