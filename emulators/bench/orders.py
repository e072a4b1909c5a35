"""The commands of a mission's step, and how a ground station insists on an answer to each."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

from emulators.bench.foreign_datagrams import command
from emulators.bench.step import Sends, Step, inputs
from firmware_bridge.mavlink.frames import Message, dialect
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, Nanoseconds

RETRY_AFTER: Final[Nanoseconds] = 500 * MILLISECOND
"""Interval of repetition, as in MAVSDK."""
NEXT_AFTER: Final[Nanoseconds] = 10 * MILLISECOND
"""A command of the same number follows an answer."""
MOST_TRIES: Final = 4
MOST_REJECTIONS: Final = 20
"""Number of retries of a command that the robot rejects temporarily: 10 s long."""

CONFIRM: Final = 31010
"""USER_1: an axis by its place in the robot file, from 1, and where it stands."""

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

    def try_again(self, now: Nanoseconds) -> bool:
        """Repeat the command later, as a new one; False where that was often enough."""
        self.tries = 0
        self.rejections += 1
        self.due = now + RETRY_AFTER
        return self.rejections <= MOST_REJECTIONS


def of_step(step: Step, robot: AnyRobot, now: Nanoseconds) -> Iterator[Pending]:
    """Yield the commands of a step, the most urgent first, and then where axes stand."""
    rows = [(key, row) for key, row in inputs(type(step)).items() if isinstance(row, Sends)]
    # Stops first: a step that stops and arms must never arm for one message.
    for key, row in sorted(rows, key=lambda pair: -pair[1].urgency):
        value = getattr(step, key)
        if value is not None:
            title = key.removesuffix("_m").replace("_", " ")
            yield Pending(title, row.command, row.params(value, robot), now)
    places = {axis.role: place for place, axis in enumerate(robot.axes, 1)}
    for role, value in (step.zero or {}).items():
        yield Pending(f"zero of {role}", CONFIRM, (places[role], value), now)
    for role in step.home or ():
        yield Pending(f"homing of {role}", CONFIRM, (places[role], math.nan), now)


def first_of_each(pending: list[Pending]) -> list[Pending]:
    """Return the commands that are due: an answer carries a number alone, so one of each is under way."""
    return list({one.number: one for one in reversed(pending)}.values())[::-1]
