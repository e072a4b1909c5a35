"""One step of a mission: an operator's actions at one instant, and the declaration of a robot's inputs."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from typing import Annotated, Any, Literal, Self

from pydantic import Field, model_validator

from emulators.bench.foreign_datagrams import Stray
from firmware_bridge.mavlink.modes import number_of_own
from firmware_bridge.renamed import step_table
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.table import Table
from firmware_bridge.robot_types import robot_type_of

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Share = Annotated[float, Field(ge=0, le=1)]


@dataclass(frozen=True, slots=True)
class Holds:
    """The step's value goes to a channel of the hand, and stays there until a later step."""

    channel: str
    into: Callable[[float, AnyRobot], float] = lambda value, _robot: value
    """Conversion from the key's unit to the channel's."""


@dataclass(frozen=True, slots=True)
class Slope:
    """The step's value is how fast a channel goes where another key sends it, per second."""

    channel: str


@dataclass(frozen=True, slots=True)
class Sends:
    """The step's value is a command, which the station repeats until it is answered."""

    command: int
    """MAV_CMD."""
    params: Callable[[float, AnyRobot], tuple[float, ...]]
    urgency: int = 0
    """The highest goes first: stops before everything else."""


@dataclass(frozen=True, slots=True)
class Presses:
    """The step taps a button of the stick."""

    buttons: dict[str, int]
    """Bits of the buttons, by the words of a mission."""


class Input(StrEnum):
    """Message by which the operator drives."""

    STICK = "stick"
    """MANUAL_CONTROL: shares of the robot's limits; cannot ask for more than those."""
    TWIST = "twist"
    """SET_POSITION_TARGET_LOCAL_NED: speed and yaw rate; any value is sent."""


_ARM_DISARM = 400
_SAFETY_SWITCH = 5300
_TERMINATE = 185
_PAUSE_CONTINUE = 193
_FORCE = 21196


class Step(Table):
    """An operator's actions at one instant; a robot's own step adds its inputs as fields."""

    at_s: NonNegative
    title: Annotated[str, Field(min_length=1, max_length=100)]
    input: Annotated[Input | None, Field(strict=False)] = None
    arm: Annotated[Literal[True] | None, Sends(_ARM_DISARM, lambda _, __: (1.0,))] = None
    disarm: Annotated[Literal[True] | None, Sends(_ARM_DISARM, lambda _, __: (0.0,), 1)] = None
    force_disarm: Annotated[Literal[True] | None, Sends(_ARM_DISARM, lambda _, __: (0.0, _FORCE), 2)] = None
    emergency_stop: Annotated[Literal[True] | None, Sends(_SAFETY_SWITCH, lambda _, __: (0.0,), 5)] = None
    clear: Annotated[Literal[True] | None, Sends(_SAFETY_SWITCH, lambda _, __: (1.0,), 3)] = None
    """Clear the emergency stop."""
    terminate: Annotated[Literal[True] | None, Sends(_TERMINATE, lambda _, __: (1.0,), 4)] = None
    """Emergency stop for good."""
    zero: Annotated[dict[str, Finite] | None, Field(min_length=1)] = None
    """Positions of axes, by their roles, as read off the robot; the robot needs them before it is armed."""
    confirm: Literal[True] | None = None
    """Confirm that each axis that needs it stands at its start position; `zero` names others."""
    home: Annotated[tuple[str, ...] | None, Field(min_length=1, strict=False)] = None
    """Let axes find their zero, by their roles, one after the other; they move."""
    pause: Annotated[bool | None, Sends(_PAUSE_CONTINUE, lambda wait, _: (0.0 if wait else 1.0,), 1)] = None
    """True: stop and wait there; false: continue, the stick at neutral."""
    mode: Annotated[
        str | None, Sends(176, lambda mode, robot: (1.0, number_of_own(modes(robot).index(mode))))
    ] = None
    """DO_SET_MODE's custom mode: go on after an actuator has failed, by the mode's name; "" is whole."""
    path_follower: Annotated[
        str | None, Sends(176, lambda name, robot: (1.0, 0.0, path_followers(robot).index(name)))
    ] = None
    """DO_SET_MODE's submode: let a path follower of the robot's drive, by its name; "" is the operator."""
    silent_s: Positive | None = None
    """Time for which the station sends nothing at all."""
    stray: Annotated[Stray | None, Field(strict=False)] = None
    """Send one thing that no operator should."""

    @model_validator(mode="before")
    @classmethod
    def _takes_old_keys(cls, table: Any) -> Any:
        return step_table(table)

    @model_validator(mode="after")
    def _does_something_once(self) -> Self:
        given = self.model_fields_set - {"at_s", "title"}
        rows = {key: of_key(type(self), key) for key in given}
        if not given - {key for key, row in rows.items() if isinstance(row, Slope)}:
            raise ValueError("the step does nothing")
        held: dict[str, str] = {}
        for key, row in rows.items():
            if isinstance(row, Holds) and getattr(self, key) is not None:
                if row.channel in held:
                    both = " and ".join(sorted((held[row.channel], key), reverse=True))
                    raise ValueError(f"{both} set the same value: give one of them")
                held[row.channel] = key
        for key, row in rows.items():
            if isinstance(row, Slope) and row.channel not in held:
                others = [name for name, of in inputs(type(self)).items() if _holds(of, row.channel)]
                raise ValueError(f"{key} needs {' or '.join(others)}")
        return self


def path_followers(robot: AnyRobot) -> tuple[str, ...]:
    """Return who may drive a robot, in the order of their numbers; the first is the operator."""
    return ("", *robot_type_of(robot).path_followers)


def modes(robot: AnyRobot) -> tuple[str, ...]:
    """Return a robot's modes, in the order of their places; the first is the whole robot."""
    return ("", *robot_type_of(robot).modes)


def of_key(step: type[Step], key: str) -> object:
    """Return the action on the controls for a key of a step; None where the key has no annotation."""
    rows = (
        row for row in step.model_fields[key].metadata if isinstance(row, Holds | Slope | Sends | Presses)
    )
    return next(rows, None)


def inputs(step: type[Step]) -> dict[str, object]:
    """Return what the hand does about each key that has a row, in the order of the fields."""
    return {key: row for key in step.model_fields if (row := of_key(step, key)) is not None}


def _holds(row: object, channel: str) -> bool:
    return isinstance(row, Holds) and row.channel == channel
