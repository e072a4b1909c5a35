"""Failures of emulated devices that a ground station injects: MAV_CMD_INJECT_FAILURE's units, a row each.

Source: common.xml, FAILURE_UNIT and FAILURE_TYPE. An instance is an axis of the robot file, from 1; 0 is all.
Which kind of fault stands for a type depends on the axis's device: the first kind that it can have.
"""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any, Final, TypeAlias

from pydantic import ValidationError

from emulators.bench.faults import Faults, read
from emulators.bench.faults.schedule import FaultError
from firmware_bridge.mavlink.command import ACCEPTED, CommandAnswer, denied
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import to_seconds

Kinds: TypeAlias = tuple[Mapping[str, Any], ...]
"""Tables of faults, without node and instant; the first that fits is taken."""

MOTOR: Final = dialect.FAILURE_UNIT_SYSTEM_MOTOR
CAMERAS: Final = dialect.FAILURE_UNIT_SENSOR_VIO
NAMES: Final[Mapping[int, str]] = MappingProxyType({MOTOR: "motor", CAMERAS: "motion capture"})
ROWS: Final[Mapping[int, Mapping[int, Kinds]]] = MappingProxyType(
    {
        MOTOR: {
            dialect.FAILURE_TYPE_OFF: ({"kind": "motor_cable_off"}, {"kind": "drive_restart"}),
            dialect.FAILURE_TYPE_STUCK: ({"kind": "shaft_blocked"}, {"kind": "set_points_ignored"}),
            dialect.FAILURE_TYPE_WRONG: ({"kind": "motor_leads_swapped"}, {"kind": "encoder_swapped"}),
            dialect.FAILURE_TYPE_INTERMITTENT: ({"kind": "frame_loss", "share": 0.5},),
        },
        CAMERAS: {
            dialect.FAILURE_TYPE_OFF: ({"kind": "capture_loss"},),
            dialect.FAILURE_TYPE_INTERMITTENT: ({"kind": "capture_loss", "share": 0.5},),
        },
    }
)
TYPES: Final[Mapping[int, str]] = MappingProxyType(
    {
        dialect.FAILURE_TYPE_OFF: "off",
        dialect.FAILURE_TYPE_STUCK: "stuck",
        dialect.FAILURE_TYPE_WRONG: "wrong",
        dialect.FAILURE_TYPE_INTERMITTENT: "intermittent",
    }
)


class InjectedFaults:
    """The failures of one bench's devices; a `firmware_bridge.mavlink.injection.DeviceFailures`."""

    def __init__(self, robot: AnyRobot, faults: Faults) -> None:
        self._robot: Final = robot
        self._faults: Final = faults
        self._on: dict[int, tuple[int, int, str]] = {}
        """Unit, instance and name of each fault that was begun here, by its number."""

    @property
    def units(self) -> str:
        """The units that they have, for people."""
        return ", ".join(f"{name} ({unit})" for unit, name in NAMES.items())

    @property
    def active(self) -> tuple[str, ...]:
        """What is on, for people."""
        return tuple(name for _, _, name in self._on.values())

    def request(self, unit: int, type_: int, instance: int) -> CommandAnswer | None:
        """Begin a failure at this instant, or end those of a unit; None for a unit that is none of theirs."""
        types = ROWS.get(unit)
        if types is None:
            return None
        axes = len(self._robot.axes) if unit == MOTOR else 1
        if instance > axes:
            return denied(f"inject failure: {NAMES[unit]} has instances 1 to {axes}, and 0 for all")
        if type_ == dialect.FAILURE_TYPE_OK:
            self._end(unit, instance)
            return ACCEPTED
        if type_ not in types:
            known = ", ".join(f"{number}: {TYPES[number]}" for number in types)
            return denied(f"inject failure: types of {NAMES[unit]} are 0: none, {known}")
        before = dict(self._on)
        for one in range(1, axes + 1) if instance == 0 else (instance,):
            if problem := self._begin(unit, type_, one):
                # All of them or none.
                for number in self._on.keys() - before.keys():
                    self._faults.end_soon(number)
                self._on = before
                return denied(f"inject failure: {problem}")
        return ACCEPTED

    def clear(self) -> None:
        """End all of them."""
        for unit in ROWS:
            self._end(unit, 0)

    def _begin(self, unit: int, type_: int, instance: int) -> str:
        """Begin the first kind of fault that the device can have; return why none can be."""
        axis = self._robot.axes[instance - 1].name if unit == MOTOR else ""
        problem = ""
        for table in ROWS[unit][type_]:
            named = {"node": axis} if axis else {}
            try:
                fault = read({**table, **named, "at_s": to_seconds(self._faults.now)}, self._robot)
                number = self._faults.plan([fault])
            except (FaultError, ValidationError) as error:
                problem = problem or _first(error)
                continue
            self._on[number] = (unit, instance, " ".join(filter(None, (fault.kind, axis))))
            return ""
        return problem

    def _end(self, unit: int, instance: int) -> None:
        for number in tuple(self._of(unit, instance)):
            del self._on[number]
            self._faults.end_soon(number)

    def _of(self, unit: int, instance: int) -> Iterator[int]:
        for number, (its_unit, its_instance, _) in self._on.items():
            if its_unit == unit and instance in {0, its_instance}:
                yield number


def _first(error: FaultError | ValidationError) -> str:
    """Return what is wrong in one line."""
    if isinstance(error, FaultError):
        return error.problems[0][1]
    return str(error.errors()[0]["msg"])
