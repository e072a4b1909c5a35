"""One command of a ground station, and what it is answered with; source: common.xml, MAV_RESULT."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, TypeAlias

from firmware_bridge.intent import Verdict
from firmware_bridge.teleop.exchange import Exchange


class Result(IntEnum):
    """MAV_RESULT."""

    ACCEPTED = 0
    TEMPORARILY_REJECTED = 1
    DENIED = 2
    UNSUPPORTED = 3
    FAILED = 4


@dataclass(frozen=True, slots=True)
class Order:
    """One command with its seven parameters, whichever message carried it."""

    command: int
    params: tuple[float, float, float, float, float, float, float]


@dataclass(frozen=True, slots=True)
class Answer:
    """The result, and where it is a refusal the reason for people."""

    result: Result
    reason: str = ""


ACCEPTED: Final = Answer(Result.ACCEPTED)
Action: TypeAlias = Callable[[Order, Exchange], Answer]


def denied(reason: str) -> Answer:
    """Refuse for good."""
    return Answer(Result.DENIED, reason)


def judged(verdict: Verdict) -> Answer:
    """Return the bridge's verdict as an answer."""
    if verdict.accepted:
        return ACCEPTED
    return Answer(Result.TEMPORARILY_REJECTED if verdict.temporary else Result.DENIED, verdict.reason)


def whole(parameter: float) -> int | None:
    """Return a parameter that is a whole number, not below 0; None for any other."""
    if math.isfinite(parameter) and parameter >= 0.0 and parameter == int(parameter):
        return int(parameter)
    return None
