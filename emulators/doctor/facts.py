"""The facts of a machine: plain values, so that a row can be judged without that machine.

It does not depend on their sources or their interpretation.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from firmware_bridge.units import Nanoseconds

Version = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class CanInterface:
    """A CAN interface of the kernel."""

    name: str
    up: bool
    virtual: bool = False
    bit_rate: int | None = None
    """Bit rate; None where it is not reported: a virtual one has none."""
    state: str | None = None
    """The controller's, as the kernel spells it: ERROR-ACTIVE, BUS-OFF ..."""


@dataclass(frozen=True, slots=True)
class SerialPort:
    """A serial port, and the user's right to open it."""

    device: str
    title: str
    allowed: bool
    group: str = ""
    """Group that owns it, beside root."""


@dataclass(frozen=True, slots=True)
class Library:
    """A library that is needed: the least version, and the one that is installed."""

    name: str
    least: Version
    installed: Version | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Facts:
    """One machine, as it was found."""

    python: Version
    system: str
    """The operating system's name: Linux, Darwin, Windows."""
    release: str
    socketcan: bool
    """True if the kernel provides raw CAN sockets."""
    vcan: bool
    """True if the kernel has virtual CAN interfaces, or a module for them."""
    interfaces: tuple[CanInterface, ...]
    ports: tuple[SerialPort, ...]
    user: str
    resolution: Nanoseconds
    """Resolution of the clock that never steps."""
    late: tuple[Nanoseconds, ...]
    """Delays with which some sleeps of 10 ms have woken."""
    load: float | None
    """Processes that ran or wanted to, over the last minute; None where the system does not report it."""
    processors: int
    compiler: str | None
    headers: bool
    """True if Python's own headers are there."""
    kernel_built: bool
    kernel_problem: str
    """Reason why the servo kernel is not used; empty where it is."""
    compiled: Mapping[str, bool]
    """Modules of the core, and whether they are translated to C."""
    plants: Mapping[str, bool | None]
    """Plants, with True for those that are built; None where that cannot be determined."""
    libraries: tuple[Library, ...]
    unwatched: Mapping[str, bool]
    """Links of installed robots, as ROBOT:LINK, whose devices run on when the bridge falls silent, each with
    whether its file accepts that."""
    extras: Mapping[str, tuple[str, ...]]
    """Extras, and which of their libraries are not installed."""


def version_of(text: str) -> Version:
    """Return the numbers at the beginning of a version: 4.6.1 of `4.6.1`, 2.0 of `2.0rc1`."""
    numbers: list[int] = []
    for part in text.split("."):
        digits = part[: len(part) - len(part.lstrip("0123456789"))]
        if not digits:
            break
        numbers.append(int(digits))
        # The first part with letters ends it: 2.0rc1 is 2.0.
        if digits != part:
            break
    return tuple(numbers)


def interfaces_of(listing: str) -> tuple[CanInterface, ...]:
    """Return the CAN interfaces in what `ip -j -details link` prints; none where it is no such listing."""
    try:
        rows = json.loads(listing)
    except ValueError:
        return ()
    return tuple(_interface(row) for row in rows if row.get("link_type") == "can")


def _interface(row: Mapping[str, Any]) -> CanInterface:
    kind = row.get("linkinfo", {})
    data = kind.get("info_data", {})
    return CanInterface(
        row["ifname"],
        "UP" in row.get("flags", ()),
        kind.get("info_kind") == "vcan",
        # Absent for virtual interfaces, and before a bit rate was set.
        data.get("bittiming", {}).get("bitrate"),
        data.get("state"),
    )
