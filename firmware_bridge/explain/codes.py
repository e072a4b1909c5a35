"""A number explained: every meaning that it may have on a CANopen bus, a row for each kind of reading.

Texts come from the families' dictionaries and CiA 301's tables; none is repeated here.
"""

import re
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import abort, cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import ControlwordBit, PowerState, Status, towards, word_of
from firmware_bridge.canopen.pdo import MappingEntry
from firmware_bridge.dissector.canopen import BY_DEFAULT, OTHER, Canopen, service_name
from firmware_bridge.dissector.dictionary import Dictionary, dictionaries
from firmware_bridge.explain.remedies import ABORT_CHECKS, class_of, remedy_of
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet

_NUMBER: Final = re.compile(
    r"(?:0[xX](?P<hex>[0-9A-Fa-f]{1,8})|(?P<h>[0-9A-Fa-f]{1,8})[hH]|(?P<bare>[0-9A-Fa-f]{1,10}))"
)
_WORD_MASK: Final = 0xFFFF
_BYTE: Final = 0xFF
_SIGN: Final = 0x80
_RESERVED: Final = 0xFC00
"""Controlword bits that are reserved or a maker's."""
_WARNING: Final = 1 << 7
_MAKERS: Final = 0x0F00_FF00
"""Device errors of a maker; a byte more."""
_DIGITS: Final = 8


@dataclass(frozen=True, slots=True)
class Reading:
    """One meaning of a number."""

    kind: str
    """As the row is named."""
    title: str
    lines: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class _Row:
    words: tuple[str, ...]
    """Words before the number that choose this reading."""
    read: "Callable[[int], Iterator[Reading]]"
    alone: "Callable[[int], bool]"
    """Whether a number without a word may be meant like this."""


def values_of(text: str) -> tuple[int, ...]:
    """Return the numbers that a text may stand for; none where it is no number.

    Without a prefix it is read as hexadecimal first, as error lists are written, and then as decimal.
    """
    match = _NUMBER.fullmatch(text.replace("_", ""))
    if match is None:
        return ()
    digits = match["hex"] or match["h"]
    if digits is not None:
        return (int(digits, 16),)
    bare = match["bare"]
    found = [int(bare, 16)] if len(bare) <= _DIGITS else []
    if bare.isdecimal() and int(bare) <= 0xFFFF_FFFF:  # noqa: PLR2004 - 32 bits
        found.append(int(bare))
    return tuple(dict.fromkeys(found))


def readings(words: tuple[str, ...]) -> tuple[Reading, ...] | None:
    """Return the readings of a number, with or without a word before it; None where there is no number."""
    text = words[-1] if words else ""
    values = values_of(text)
    if not values:
        return None
    chosen = " ".join(words[:-1]).lower()
    rows = [row for row in _ROWS if not chosen or chosen in row.words]
    for value in values:
        found = [one for row in rows if chosen or row.alone(value) for one in row.read(value)]
        if found:
            return tuple(found)
    return ()


def names() -> tuple[str, ...]:
    """Return the words that may stand before a number."""
    return tuple(row.words[0] for row in _ROWS)


# Rows


def _errors(value: int) -> Iterator[Reading]:
    if not 0 <= value <= _WORD_MASK:
        return
    by_text: dict[str, list[str]] = {}
    for name, dictionary in dictionaries().items():
        cause = dictionary.words.causes.get(value)
        if cause is not None:
            by_text.setdefault(cause, []).append(name)
    if value == 0:
        yield Reading("error code", "EMCY 0x0000: no error is left (error reset)")
        return
    about, remedy = class_of(value), remedy_of(value)
    lines = (
        *(f"meaning: {text} ({', '.join(families)})" for text, families in by_text.items()),
        *((f"class: {about}",) if about else ()),
        *(f"{'cause' if not place else 'or'}: {cause}" for place, cause in enumerate(remedy.causes)),
        f"check first: {remedy.check}",
        f"remedy: {remedy.reset}",
    )
    title = next(iter(by_text), "an error that is in no family's list")
    yield Reading("error code", f"EMCY / error code 0x{value:04X}: {title}", lines)


def _known_error(value: int) -> bool:
    return value in {code for one in dictionaries().values() for code in one.words.causes} or value == 0


def _aborts(value: int) -> Iterator[Reading]:
    text = abort.meaning_of(value)
    if value in set(AbortCode):
        maker = value & ~_BYTE == _MAKERS
        kind = "device error of maxon's drives" if maker else "SDO abort code"
        lines = (f"check first: {ABORT_CHECKS[value]}",) if value in ABORT_CHECKS else ()
        yield Reading("abort code", f"{kind} {text}", lines)
    elif value & ~_BYTE == _MAKERS:
        title = f"device error 0x{value:08X} of maxon's range 0x0F00FFxx; this one is in no list"
        yield Reading("abort code", title)


def _statuswords(value: int) -> Iterator[Reading]:
    if not 0 <= value <= _WORD_MASK:
        return
    by_lines: dict[tuple[str, ...], list[str]] = {}
    for name, dictionary in dictionaries().items():
        if dictionary.words.states.state_of(value) is not None:
            by_lines.setdefault(_status_lines(dictionary, value), []).append(name)
    for lines, families in by_lines.items():
        state, *bits = lines
        yield Reading("statusword", f"statusword 0x{value:04X}: {state} ({', '.join(families)})", tuple(bits))


def _status_lines(dictionary: Dictionary, value: int) -> tuple[str, ...]:
    words, state = dictionary.words, dictionary.words.states.state_of(value)
    texts = words.words(od.STATUSWORD, value)
    lines = [texts[0], *(f"bit: {text}" for text in texts[1:] if not text.startswith("bit "))]
    for number, by_mode in ((12, words.bit_12), (13, words.bit_13)):
        if value >> number & 1:
            meanings = ", ".join(
                f"{text} ({words.title(words.mode_of(mode))})"
                for mode, text in by_mode.items()
                if words.mode_of(mode) is not None
            )
            lines.append(f"bit {number}, by mode: {meanings}")
    if value & _WARNING:
        lines.append("bit 7: warning")
    if not value & Status.REMOTE:
        lines.append("bit 9 (remote) is 0: it takes no controlword from the bus, as before NMT start")
    step = towards(state, PowerState.OPERATION_ENABLED)
    if step is not None:
        lines.append(f"next towards operation enabled: controlword 0x{word_of(step):04X} ({step.value})")
    elif state is PowerState.FAULT:
        lines.append("next: remove the cause (0x1003), then controlword 0x0080, a 0 -> 1 change of bit 7")
    return tuple(lines)


def _controlwords(value: int) -> Iterator[Reading]:
    if not 0 <= value <= _WORD_MASK:
        return
    words = next(iter(dictionaries().values())).words
    command, *bits = words.words(od.CONTROLWORD, value)
    lines = [f"bit: {text}" for text in bits]
    if value & ControlwordBit.NEW_SETPOINT:
        lines.append(
            "bit 4, by mode: new set-point (profile position), start (homing), enable (interpolated)"
        )
    if value & ControlwordBit.CHANGE_IMMEDIATELY:
        lines.append("bit 5: change immediately (profile position)")
    if value & ControlwordBit.RELATIVE:
        lines.append("bit 6: relative (profile position)")
    yield Reading("controlword", f"controlword 0x{value:04X}: {command}", tuple(lines))


def _modes(value: int) -> Iterator[Reading]:
    signed = value - 0x100 if _SIGN <= value <= _BYTE else value
    by_title: dict[str, list[str]] = {}
    for name, dictionary in dictionaries().items():
        mode = dictionary.words.mode_of(signed)
        if mode is not None:
            by_title.setdefault(dictionary.words.title(mode), []).append(name)
    for title, families in by_title.items():
        yield Reading("mode", f"mode of operation {signed}: {title} ({', '.join(families)})")


def _network_states(value: int) -> Iterator[Reading]:
    states = {int(state): state for state in NmtState}
    if value & ~cia301.TOGGLE in states and value <= _BYTE:
        yield Reading("nmt", f"NMT state 0x{value:02X}: {states[value & ~cia301.TOGGLE].title}")


def _registers(value: int) -> Iterator[Reading]:
    if 0 <= value <= _BYTE:
        words = next(iter(dictionaries().values())).words
        yield Reading(
            "register", f"error register 0x{value:02X}: {', '.join(words.words(od.ERROR_REGISTER, value))}"
        )


def _mappings(value: int) -> Iterator[Reading]:
    entry = MappingEntry.decode(value)
    for name, dictionary in dictionaries().items():
        row = dictionary.rows.get(entry.address)
        if row is not None and row.type.bits == entry.bits:
            called = dictionary.rows.called(entry.address)
            yield Reading("mapping", f"PDO mapping entry 0x{value:08X}: {called}, {entry.bits} bits ({name})")
            return


def _objects(value: int) -> Iterator[Reading]:
    for name, dictionary in dictionaries().items():
        if value in dictionary.rows.indexes:
            row = dictionary.rows.get(Address(value)) or dictionary.rows[dictionary.rows.entries(value)[0]]
            yield Reading("object", f"object 0x{value:04X}: {row.name} ({name})")
            return


def _identifiers(value: int) -> Iterator[Reading]:
    packet = Packet(CAN, value, b"")
    if 0 <= value <= cia301.COB_ID_MASK and service_name(packet) != OTHER:
        title = Canopen().read("", packet).partition(":")[0].removesuffix(BY_DEFAULT)
        yield Reading("identifier", f"CAN identifier 0x{value:03X}: {title}, by the predefined set")


def _whole(value: int) -> bool:
    return value > _WORD_MASK


def _plain_word(value: int) -> bool:
    return _BYTE < value <= _WORD_MASK and not _known_error(value)


_ROWS: Final = (
    _Row(("error", "emcy", "error code", "emergency"), _errors, _known_error),
    _Row(("abort", "sdo", "sdo abort", "device error"), _aborts, _whole),
    _Row(("mapping", "mapping entry"), _mappings, _whole),
    _Row(("object", "index"), _objects, lambda value: _BYTE < value <= _WORD_MASK),
    _Row(("statusword", "status"), _statuswords, lambda value: _BYTE < value <= _WORD_MASK),
    _Row(
        ("controlword", "control"), _controlwords, lambda value: value < _RESERVED and not value & _RESERVED
    ),
    _Row(("mode", "mode of operation"), _modes, lambda value: value <= _BYTE),
    _Row(("nmt", "heartbeat", "nmt state"), _network_states, lambda value: value <= _BYTE),
    _Row(("register", "error register"), _registers, lambda value: 0 < value <= _BYTE),
    _Row(("identifier", "id", "cob-id"), _identifiers, lambda value: 0 < value <= cia301.COB_ID_MASK),
)
"""The kinds of readings, the most likely one first."""
