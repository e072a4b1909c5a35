"""Rows of a recording, before they are messages: a drive's state, a joint, an event."""

from collections.abc import Sequence
from dataclasses import dataclass
from enum import IntEnum
from typing import NamedTuple

from firmware_bridge.units import Nanoseconds


class EventKind(IntEnum):
    """Kinds of events, with the numbers of `recording.proto`."""

    INTERLOCK_ACTIVE = 1
    INTERLOCK_CLEARED = 2
    ARMED = 3
    DISARMED = 4
    FAULT_BEGAN = 5
    FAULT_ENDED = 6


@dataclass(frozen=True, slots=True)
class EventRow:
    """One event; `recording.proto` describes the fields."""

    kind: EventKind
    name: str = ""
    text: str = ""
    remedy: str = ""
    since: Nanoseconds | None = None
    """None: it has just begun."""
    devices: Sequence[str] = ()


@dataclass(frozen=True, slots=True)
class DriveRow:
    """One drive in a cycle; `recording.proto` describes the fields."""

    axis: str
    power: str
    state: str
    unit: str
    statusword: int | None = None
    mode: int | None = None
    mode_name: str = ""
    position: float | None = None
    velocity: float | None = None
    current_a: float | None = None
    fault: str = ""


class Joint(NamedTuple):
    """One joint behind its gear: rad or m, and the same a second."""

    name: str
    position: float
    velocity: float
