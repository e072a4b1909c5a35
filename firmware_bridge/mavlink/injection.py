"""Failures that a ground station injects, where the robot's start allows it.

Source: common.xml, MAV_CMD_INJECT_FAILURE. They meet what a station sends and what a sensor reports, never a
stop: interlocks and output guard stay as they are. A stop is always received, and an emergency stop ends all
failures.
"""

import math
from collections import deque
from collections.abc import Callable, Mapping
from enum import Enum
from types import MappingProxyType
from typing import Final, Protocol, TypeVar

from firmware_bridge.mavlink.command import ACCEPTED, CommandAnswer, denied, whole
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.units import MILLISECOND, Nanoseconds

T = TypeVar("T")
LATER: Final[Nanoseconds] = 500 * MILLISECOND
"""Delay of a motion command; the message has no parameter for it."""
MOST_HELD: Final = 256
REFUSED: Final = (
    "fault injection is not allowed: start drive with --allow-fault-injection; emulated devices take faults"
    " by firmware-bridge inject"
)


class Failure(Enum):
    """What becomes of a station's messages, or of the battery's sensor."""

    LOST = "all messages are lost"
    HALVED = "every second message is lost"
    LATE = "motion commands take effect 0.5 s later"
    SILENT = "the battery's sensor is silent"


_SIGNAL: Final = (dialect.FAILURE_UNIT_SYSTEM_MAVLINK_SIGNAL, dialect.FAILURE_UNIT_SYSTEM_RC_SIGNAL)
_OF_SIGNAL: Final[Mapping[int, Failure]] = MappingProxyType(
    {
        dialect.FAILURE_TYPE_OFF: Failure.LOST,
        dialect.FAILURE_TYPE_INTERMITTENT: Failure.HALVED,
        dialect.FAILURE_TYPE_DELAYED: Failure.LATE,
        dialect.FAILURE_TYPE_SLOW: Failure.LATE,
    }
)
ROWS: Final[Mapping[int, Mapping[int, Failure]]] = MappingProxyType(
    {
        **dict.fromkeys(_SIGNAL, _OF_SIGNAL),
        dialect.FAILURE_UNIT_SYSTEM_BATTERY: {dialect.FAILURE_TYPE_OFF: Failure.SILENT},
    }
)
"""Failures by FAILURE_UNIT and FAILURE_TYPE; FAILURE_TYPE_OK ends those of a unit."""


class DeviceFailures(Protocol):
    """The failures of emulated devices; a real robot has none."""

    @property
    def units(self) -> str:
        """The units that they have, for people."""

    @property
    def active(self) -> tuple[str, ...]:
        """What is on, for people."""

    def request(self, unit: int, type_: int, instance: int) -> CommandAnswer | None:
        """Carry out one command, by FAILURE_UNIT and FAILURE_TYPE; None where they have no such unit."""

    def clear(self) -> None:
        """End all of them."""


class Injection:
    """The failures that are on."""

    __slots__ = ("_allowed", "_battery", "_held", "_second", "devices", "on")

    def __init__(self, battery: str | None, *, allowed: bool) -> None:
        """Take the name of the battery's sensor, and whether a station may inject."""
        self._allowed: Final = allowed
        self._battery: Final = battery
        self.devices: DeviceFailures | None = None
        """The emulated devices of a bridge on the bench."""
        self.on: Final[set[Failure]] = set()
        """Those that are on."""
        self._second = False
        self._held: deque[tuple[Nanoseconds, Callable[[Nanoseconds], object]]] = deque()

    def request(self, unit: float, kind: float, instance: float = 0) -> CommandAnswer:
        """Carry out one command: unit and type of the failure, and the unit's instance, from 1; 0 is all."""
        if not self._allowed:
            return denied(REFUSED)
        number, type_ = whole(unit), whole(kind)
        # Not a number stands for a parameter that the station does not use.
        which = whole(0.0 if math.isnan(instance) else instance)
        if self.devices is not None and number is not None and type_ is not None:
            if which is None:
                return denied("inject failure: the instance is a whole number, 0 for all")
            answer = self.devices.request(number, type_, which)
            if answer is not None:
                return answer
        return self._inside(number, type_)

    def _inside(self, number: int | None, type_: int | None) -> CommandAnswer:
        """Carry out what concerns the operator's link, or a sensor."""
        failures = None if number is None else ROWS.get(number)
        if failures is None or (number not in _SIGNAL and self._battery is None):
            known = "the link's signals (104, 105)" + ("" if self._battery is None else ", battery (100)")
            known += "" if self.devices is None else f", {self.devices.units}"
            return denied(f"inject failure: units of this robot are {known}")
        if type_ == dialect.FAILURE_TYPE_OK:
            self.on.difference_update(failures.values())
            return ACCEPTED
        failure = None if type_ is None else failures.get(type_)
        if failure is None:
            known = ", ".join(f"{number}: {one.value}" for number, one in failures.items())
            return denied(f"inject failure: types are 0: none, {known}")
        self.on.add(failure)
        return ACCEPTED

    def clear(self) -> None:
        """End all failures; what was held is forgotten."""
        self.on.clear()
        if self.devices is not None:
            self.devices.clear()
        self.forget()

    def forget(self) -> None:
        """Forget what is held: the station has no control any more, or a request has made it obsolete."""
        self._held.clear()

    @property
    def active(self) -> tuple[str, ...]:
        """What is on, for people."""
        of_devices = () if self.devices is None else self.devices.active
        return (*sorted(one.value for one in self.on), *of_devices)

    def loses(self) -> bool:
        """Return whether the next message is lost."""
        self._second = not self._second
        return Failure.LOST in self.on or (Failure.HALVED in self.on and self._second)

    def holds(self, now: Nanoseconds, later: Callable[[Nanoseconds], object]) -> bool:
        """Keep what a motion command does until it is late enough; False where it is not delayed."""
        if Failure.LATE not in self.on:
            return False
        if len(self._held) < MOST_HELD:
            self._held.append((now + LATER, later))
        return True

    def go_on(self, now: Nanoseconds) -> None:
        """Do what is late enough."""
        while self._held and self._held[0][0] <= now:
            _, later = self._held.popleft()
            later(now)

    def seen(self, readings: dict[str, T]) -> dict[str, T]:
        """Return the sensors' readings without those of a silent one."""
        if Failure.SILENT not in self.on:
            return readings
        return {name: reading for name, reading in readings.items() if name != self._battery}
