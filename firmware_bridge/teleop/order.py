"""One command of a ground station, and what it is answered with; source: common.xml, MAV_RESULT."""

import math
from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum
from typing import Final, TypeAlias

from firmware_bridge.intent import Answer
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
class OrderAnswer:
    """The result, and where it is a refusal the reason for people."""

    result: Result
    reason: str = ""


ACCEPTED: Final = OrderAnswer(Result.ACCEPTED)
UNSUPPORTED: Final = OrderAnswer(Result.UNSUPPORTED)
Action: TypeAlias = Callable[[Order, Exchange], OrderAnswer]


def denied(reason: str) -> OrderAnswer:
    """Refuse for good."""
    return OrderAnswer(Result.DENIED, reason)


def judged(verdict: Answer) -> OrderAnswer:
    """Return the bridge's verdict as an answer."""
    if verdict.accepted:
        return ACCEPTED
    return OrderAnswer(Result.TEMPORARILY_REJECTED if verdict.temporary else Result.DENIED, verdict.reason)


def whole(parameter: float) -> int | None:
    """Return a parameter that is a whole number, not below 0; None for any other."""
    if math.isfinite(parameter) and parameter >= 0.0 and parameter == int(parameter):
        return int(parameter)
    return None
