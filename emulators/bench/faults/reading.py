"""A table of a mission file becomes a fault, and is compared with the robot that shall meet it."""

from collections.abc import Iterator, Sequence
from typing import Annotated, Any, Final, TypeAlias

from pydantic import BeforeValidator, InstanceOf, ValidationError, ValidationInfo
from pydantic_core import ErrorDetails, InitErrorDetails, PydanticCustomError

from emulators.bench.faults.failures import failures_of
from emulators.bench.faults.fault import Fault, Problem
from emulators.bench.faults.kind import FaultKind
from emulators.bench.faults.table import kinds
from firmware_bridge.renamed import fault_table
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import near, nearest

WRONG: Final = "fault"
"""Type of pydantic's error where the message is complete by itself."""
ROBOT: Final = "robot"
"""Key of the robot in a validation's context."""
_ENDS: Final = frozenset({"until_s", "for_s"})


def read(table: Any, robot: AnyRobot | None = None) -> Fault:
    """Return the fault that a table of TOML describes; ValidationError with every key that is wrong.

    With `robot` the messages name what that one has.
    """
    if isinstance(table, Fault):
        return table
    if not isinstance(table, dict):
        raise PydanticCustomError(WRONG, "a fault is a table: [[fault]]")
    table = fault_table(table)
    rest = {key: value for key, value in table.items() if key != "kind"}
    kind = kinds().get(str(table.get("kind")))
    if kind is None:
        problem = "which fault? " if "kind" not in table else f"no such fault as '{table['kind']}'; "
        problem += _near(str(table.get("kind")), robot)
        raise ValidationError.from_exception_data(WRONG, [_error(("kind",), problem)])
    try:
        fault: Fault = kind.fault.model_validate(rest)
    except ValidationError as error:
        # One line for a key: of a value that is neither a name nor a number pydantic would say two things.
        stated = {each["loc"][:1]: _text_of(kind, each, robot) for each in reversed(error.errors())}
        raise ValidationError.from_exception_data(WRONG, list(reversed(stated.values()))) from None
    return fault


def _of_file(table: Any, info: ValidationInfo) -> Fault:
    return read(table, (info.context or {}).get(ROBOT))


FaultTable: TypeAlias = Annotated[InstanceOf[Fault], BeforeValidator(_of_file)]
"""A fault where pydantic reads a file; the context's `ROBOT` is the robot that shall meet it."""


def misfits(faults: Sequence[Fault], robot: AnyRobot) -> Iterator[Problem]:
    """Give what is wrong with these faults on this robot: all of it, with keys as `fault[2].node`."""
    for index, fault in enumerate(faults):
        problems = [(f"fault[{index}].{key}", problem) for key, problem in fault.problems(robot)]
        yield from problems
        if problems:
            continue
        for earlier, other in enumerate(faults[:index]):
            thing = _collision(fault, other, robot)
            if thing is not None:
                where = f"fault[{earlier}], '{other.kind}'"
                problem = f"acts on {thing} of the same node while {where}, still does"
                yield f"fault[{index}]", f"{problem}: let one end before the other begins"


def _collision(one: Fault, other: Fault, robot: AnyRobot) -> str | None:
    thing = kinds()[one.kind].acts_on
    if not thing or thing != kinds()[other.kind].acts_on:
        return None
    mine, yours = one.targets(robot), other.targets(robot)
    together = one.begin < other.end and other.begin < one.end and (mine & yours or not mine)
    return thing if together else None


def _near(name: str, robot: AnyRobot | None) -> str:
    """Return the ending of a message about a fault that is not known, with those that the robot can have."""
    if robot is None:
        return near(name, kinds(), most=len(kinds()))
    possible = list(dict.fromkeys(failure.kind for failure in failures_of(robot)))
    others = nearest(name, kinds())
    # A fault that only other robots can have is no help: what this one has is listed.
    meant = f"{robot.name} cannot have '{others[0]}'; " if others and not nearest(name, possible) else ""
    return (
        f"{meant}{near(name, possible, most=len(possible))} (firmware-bridge faults {robot.name} lists them)"
    )


def _text_of(kind: FaultKind, error: ErrorDetails, robot: AnyRobot | None) -> InitErrorDetails:
    """Return pydantic's finding in one sentence, with a near name for a key that is not there."""
    location = error["loc"]
    key = str(location[0]) if location else ""
    problem = error["msg"].removeprefix("Value error, ")
    if error["type"] == "extra_forbidden":
        known = [name for name in kind.fault.model_fields if name != "kind"]
        problem = f"no such key of '{kind.name}'; {near(key, known)}"
        if key in _ENDS:
            problem = f"'{kind.name}' is an instant: it has no end"
    elif error["type"] == "missing":
        among = kind.fault.among
        known = [among.value] if robot is None else among.of(robot)
        needed = f": {' or '.join(known) or 'no one here'}" if key == "node" else ""
        problem = f"{kind.name} needs {key}{needed}"
    elif not isinstance(error["input"], dict):
        problem = f"{problem}, but it is {error['input']!r}"
    return _error(tuple(location[:1]), problem)


def _error(location: tuple[int | str, ...], problem: str) -> InitErrorDetails:
    # pydantic formats the message: braces in a value would be taken for fields.
    message = problem.replace("{", "{{").replace("}", "}}")
    return InitErrorDetails(type=PydanticCustomError(WRONG, message), loc=location, input=None)
