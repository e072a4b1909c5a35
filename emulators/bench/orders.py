"""The commands of a mission's step, and how a ground station insists on an answer to each."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Final

from emulators.bench.mission import Step
from emulators.bench.strays import command
from firmware_bridge.robot import Lift, Robot
from firmware_bridge.teleop.mavlink import Message, dialect
from firmware_bridge.units import MILLISECOND, Nanoseconds

RETRY_AFTER: Final[Nanoseconds] = 500 * MILLISECOND
"""As MAVSDK repeats a command."""
MOST_TRIES: Final = 4
MOST_REJECTIONS: Final = 20
"""How often an operator tries again what the robot rejects for the moment: 10 s long."""
_FORCE: Final = 21196

RESULTS: Final = {
    dialect.MAV_RESULT_ACCEPTED: "accepted",
    dialect.MAV_RESULT_TEMPORARILY_REJECTED: "temporarily rejected",
    dialect.MAV_RESULT_DENIED: "denied",
    dialect.MAV_RESULT_UNSUPPORTED: "unsupported",
    dialect.MAV_RESULT_FAILED: "failed",
}


@dataclass(slots=True)
class Pending:
    """One command that has no final answer yet."""

    title: str
    number: int
    params: tuple[float, ...]
    due: Nanoseconds
    tries: int = 0
    rejections: int = 0

    def message(self, system: int, component: int, now: Nanoseconds) -> Message:
        """Return the command for sending now; a repetition counts up its confirmation."""
        sent = command(system, component, self.number, *self.params, confirmation=self.tries)
        self.tries += 1
        self.due = now + RETRY_AFTER
        return sent

    def try_anew(self, now: Nanoseconds) -> bool:
        """Ask again later, as a new command; False where that was often enough."""
        self.tries = 0
        self.rejections += 1
        self.due = now + RETRY_AFTER
        return self.rejections <= MOST_REJECTIONS


@dataclass(frozen=True, slots=True)
class Row:
    """One key of a step that is a command."""

    key: str
    number: int
    params: Callable[[float, Robot], tuple[float, ...]]


def _travel(lift: Lift) -> float:
    """Return how far the platform rises: N l (sin extended - sin collapsed) (thesis 2.16)."""
    low, high = math.radians(lift.collapsed_angle_deg), math.radians(lift.extended_angle_deg)
    return lift.stages * lift.link_length_m * (math.sin(high) - math.sin(low))


ROWS: Final = (
    Row("emergency_stop", dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, lambda _, __: (0.0,)),
    Row("terminate", dialect.MAV_CMD_DO_FLIGHTTERMINATION, lambda _, __: (1.0,)),
    Row("clear", dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, lambda _, __: (1.0,)),
    Row("force_disarm", dialect.MAV_CMD_COMPONENT_ARM_DISARM, lambda _, __: (0.0, _FORCE)),
    Row("disarm", dialect.MAV_CMD_COMPONENT_ARM_DISARM, lambda _, __: (0.0,)),
    Row("arm", dialect.MAV_CMD_COMPONENT_ARM_DISARM, lambda _, __: (1.0,)),
    Row("headlamp", dialect.MAV_CMD_ILLUMINATOR_ON_OFF, lambda on, _: (float(on),)),
    Row("detector", dialect.MAV_CMD_DO_SET_RELAY, lambda on, _: (0.0, float(on))),
    Row(
        "lift_m",
        dialect.MAV_CMD_DO_SET_ACTUATOR,
        lambda height, robot: (2.0 * height / _travel(robot.lift) - 1.0,),
    ),
)


def of_step(step: Step, robot: Robot, now: Nanoseconds) -> Iterator[Pending]:
    """Yield the commands of a step, the stops first."""
    for row in ROWS:
        value = getattr(step, row.key)
        if value is not None:
            yield Pending(
                row.key.removesuffix("_m").replace("_", " "), row.number, row.params(value, robot), now
            )
