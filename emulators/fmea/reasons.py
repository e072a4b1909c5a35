"""Why a failure may go unnoticed although the robot moves: a row each, so that no other one does."""

from dataclasses import dataclass
from typing import Final

from emulators.fmea.failures import Failure


@dataclass(frozen=True, slots=True)
class Reason:
    """One kind of fault that somebody has thought about."""

    kind: str
    why: str
    state: str = ""
    """In this state alone; empty: in all of them."""


REASONS: Final = (
    Reason("bridge_ends", "nobody is left to say so: its end, and the devices' own watch, stop the robot"),
    Reason(
        "load_lifted",
        "a motor whose load is off the floor turns as it is told: cameras alone see it, and only when the"
        " base is further from where its motors say than `base slips` allows",
    ),
    Reason("motor_supply_sag", "it turns slower by less than an axis may stray"),
    Reason(
        "encoder_frozen",
        "at small speeds it takes half a second until it owes more way than it may creep",
        state="stopping",
    ),
)


def reason(failure: Failure, state: str) -> str:
    """Return why this failure may go unnoticed in this state; empty where it may not."""
    found = (row.why for row in REASONS if row.kind == failure.kind and row.state in {"", state})
    return next(found, "")
