"""What stops RARS, asked for or failing: a row each, with how it begins and what has to notice it.

`drive.py` drives them, `measured.toml` keeps the worst that came of it, and `docs/safety.md` shows both.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Final

LINKS: Final = ("can", "serial")
CAN: Final = ("can",)
SERIAL: Final = ("serial",)


class By(Enum):
    """Who begins it."""

    OPERATOR = "operator"
    """Keys of a mission's step."""
    FAULT = "fault"
    """A kind of fault."""
    PROGRAM = "program"
    """The bridge's own process: "ends" as by Ctrl-C, "dies" as by SIGKILL."""


@dataclass(frozen=True, slots=True)
class Motion:
    """What the robot does when it begins."""

    name: str
    steps: Mapping[str, float]
    axis: str
    """Which axis a failure of one axis hits: one that moves."""
    lifts: bool = False
    """Whether the way that counts is the lift's."""


DRIVING: Final = (
    Motion("ahead at 0.5 m/s", {"speed_mps": 0.5}, "left"),
    Motion("backwards at 0.5 m/s", {"speed_mps": -0.5}, "right"),
    Motion("at 0.4 m/s in a turn", {"speed_mps": 0.4, "steer_deg": 12.0}, "steer"),
)
LIFTING: Final = Motion("lifting at 0.1 m/s", {"lift_rate_mps": 0.1}, "lift", lifts=True)
MOTIONS: Final = (*DRIVING, LIFTING)
PHASES_MS: Final = (0, 17, 34)
"""When in a cycle of 50 ms it begins."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """Why the robot stops; the texts are cells of a table."""

    name: str
    by: By
    what: str = ""
    """The kind of fault, or what the program does."""
    how: Mapping[str, object] = field(default_factory=dict)
    """The step's or the fault's keys."""
    hits: bool = False
    """Whether it hits one axis, the motion's."""
    links: tuple[str, ...] = LINKS
    motions: tuple[Motion, ...] = MOTIONS
    tells: tuple[str, ...] = ()
    """One of these holds begins, by how its name begins; empty: the order is its own word."""
    category: int | None = None
    """Of the stop (EN 60204-1), where it is one that somebody asks for."""
    answer: str
    """What the bridge, or the drives, do."""
    remains: str = "-"
    """What is left to the user."""


_ROLLS: Final = "an axis without torque rolls out; on a slope only brakes hold it"
_OFF: Final = "that drive has no power at once; the others ramp"

ASKED: Final = (
    Cause(
        name="stick let go",
        by=By.OPERATOR,
        how={"speed_mps": 0.0, "steer_deg": 0.0, "lift_rate_mps": 0.0},
        category=2,
        answer="ramp",
    ),
    Cause(name="pause", by=By.OPERATOR, how={"pause": True}, tells=("paused",), category=2, answer="ramp"),
    Cause(
        name="disarm", by=By.OPERATOR, how={"disarm": True}, tells=("not armed",), category=2, answer="ramp"
    ),
    Cause(
        name="emergency stop",
        by=By.OPERATOR,
        how={"emergency_stop": True},
        tells=("emergency stop",),
        category=1,
        answer="ramp, then no power where it stands by itself; latched",
    ),
    Cause(
        name="termination",
        by=By.OPERATOR,
        how={"terminate": True},
        tells=("emergency stop",),
        category=1,
        answer="as the emergency stop, and nothing clears it",
    ),
    Cause(
        name="forced disarm",
        by=By.OPERATOR,
        how={"force_disarm": True},
        tells=("not armed",),
        category=1,
        answer="quick stop, then no power in any place",
        remains="on a slope it rolls then: brakes",
    ),
    Cause(
        name="end of the program",
        by=By.PROGRAM,
        what="ends",
        tells=("ending",),
        category=1,
        answer="ramp, then no power where it stands by itself",
    ),
)
"""Somebody asks for it."""

FAILS: Final = (
    Cause(
        name="operator's link dead",
        by=By.OPERATOR,
        how={"silent_s": 20.0},
        tells=("operator silent",),
        answer="ramp",
    ),
    Cause(
        name="bridge's process dead",
        by=By.PROGRAM,
        what="dies",
        answer="each drive stops by its own watch, and has no power then",
        remains="on a slope it rolls then: brakes",
    ),
    Cause(
        name="bridge's CAN adapter unplugged",
        by=By.FAULT,
        what="can_cut",
        how={"between": ["bridge", "left"]},
        links=CAN,
        tells=("axis silent", "axis answers late", "left"),
        answer="each drive stops by its own watch, and has no power then",
        remains="on a slope it rolls then: brakes",
    ),
)
