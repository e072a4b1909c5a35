"""One protective function of a robot against one hazard: what trips it, what it leaves, which test shows it.

Words: hazard and residual risk by ISO 12100. What follows when it trips is not stated here: it is read from
the interlock itself, and distances from what was measured.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from firmware_bridge.robot import AnyRobot

Trips: TypeAlias = Callable[[AnyRobot], str]

OWN_CASES: Final = (
    "hil_tests/robots/test_every_robot.py::test_at_its_threshold_an_interlock_is_active_and_states_why"
)
"""The test of each interlock and limit that a robot type brings: at its threshold, and just within."""


def any_robot(_: AnyRobot) -> bool:
    """Return True: most functions are every robot's."""
    return True


@dataclass(frozen=True, slots=True)
class Function:
    """One row: a function is an interlock, a limit, or what stands beside them."""

    name: str
    """Its name; an interlock's without the link or axis behind the colon."""
    hazard: str
    residual: str
    """What it leaves to the user; "-" for nothing that is known."""
    trips: Trips | None = None
    """Value and time, from the robot; None: the reason of its boundary case."""
    test: str = OWN_CASES
    """File and name."""
    causes: tuple[str, ...] = ()
    """Names of causes in the fault matrix whose stop it begins."""
    reaction: str = ""
    """Where it does not follow from the interlock's own properties; empty: read from those."""
    applies: Callable[[AnyRobot], bool] = any_robot
