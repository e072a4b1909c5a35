"""Causes of a stop, or of none: orders and faults, a row each, and the required result of each.

`drive.py` drives them, `outcomes.csv` keeps the results, and `docs/safety.md` shows both.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Final, NamedTuple

from emulators.testing.hand import TestOperator

CAN: Final = ("rars",)
SERIAL: Final = ("rars+serial",)
RARS: Final = CAN + SERIAL
BOARDS: Final[Mapping[str, tuple[str, ...]]] = {
    "rome": ("rome:ros-arduino-bridge", "rome:mw:3", "rome:arduinoio:3", "rome+cameras:firmata"),
    "rome_arm": ("rome_arm", "rome_arm:mw:3"),
    "ar2": ("ar2",),
}
LINES: Final[Mapping[str, tuple[str, ...]]] = {
    "rars": RARS,
    "climber": ("climber", "climber+serial"),
    "servo_axis": ("servo_axis",),
    **BOARDS,
}
"""Links of each robot, as `driving.robot_of` reads them."""
EVERY: Final = tuple(line for lines in LINES.values() for line in lines)
ON_BOARDS: Final = tuple(line for lines in BOARDS.values() for line in lines)


@dataclass(frozen=True, slots=True)
class Motion:
    """Motion of a robot when the cause begins."""

    name: str
    steps: Mapping[str, Any] = field(default_factory=dict)
    """Keys of a mission's step; none: straight ahead, as `driving` drives."""
    axis: str = ""
    """The moving axis hit by a fault of one axis; empty: the robot's own of `HIT`."""
    then: Mapping[str, Any] = field(default_factory=dict)
    """The operator's command right after such a fault: at rest an axis shows little."""
    lifts: bool = False
    """True if the stopping distance that counts is the lift's."""


STRAIGHT: Final = Motion("straight ahead")
HIT: Final = {"rars": "left", "climber": "left", "servo_axis": "axis", "rome": "two", "rome_arm": "two"}
AHEAD: Final = Motion("ahead at 0.5 m/s", {"speed_mps": 0.5}, "left")
BACK: Final = Motion("backwards at 0.5 m/s", {"speed_mps": -0.5}, "right")
TURNING: Final = Motion(
    "at 0.4 m/s in a turn", {"speed_mps": 0.4, "steer_deg": 12.0}, "steer", then={"steer_deg": -12.0}
)
LIFTING: Final = Motion("lifting at 0.1 m/s", {"lift_rate_mps": 0.1}, "lift", lifts=True)
WORST_OF: Final = (AHEAD, BACK, TURNING, LIFTING)
"""RARS's: the worst of them is kept."""
PHASES_MS: Final = (0, 17, 34)
"""Instants in a cycle of 50 ms at which such a cause begins."""


class Fault(NamedTuple):
    """A fault, as in a mission."""

    kind: str
    keys: Mapping[str, Any]
    hits: bool = False
    """True if it hits one axis, the motion's."""


def fault(kind: str, **keys: Any) -> Fault:
    """Return a fault that names what it hits, or hits all."""
    return Fault(kind, keys)


def hits(kind: str, **keys: Any) -> Fault:
    """Return a fault of one axis, the motion's."""
    return Fault(kind, keys, hits=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Cause:
    """One order or fault; `answer` and `remains` are cells of a table."""

    name: str
    order: Callable[[TestOperator], None] | None = None
    """The operator's action."""
    fault: Fault | Mapping[str, Fault] | None = None
    """The fault; by the robot's link, where that differs: can, serial or board."""
    lines: tuple[str, ...] = ()
    """Driven straight ahead on these."""
    worst_of: tuple[Motion, ...] = ()
    """RARS is driven with each of these, too, and the worst is kept."""
    on: tuple[str, ...] = RARS
    """On these lines."""
    returns_to_neutral: bool = False
    """True if the operator lets go at that instant: the fault shows by it."""
    reports: tuple[str, ...] = ()
    """One of these interlocks begins to hold, by how its name begins."""
    interlock_events: tuple[str, ...] = ()
    """Each of these begins to hold."""
    only: bool = False
    """True if no other interlock becomes active; with none in `holds` the robot drives on."""
    codes: Mapping[str, tuple[int, ...]] | None = None
    """Each drive's error history (object 0x1003), newest first; a drive that is not named has none."""
    again: bool = False
    """True if the operator can arm and drive it again afterwards."""
    category: int | None = None
    """Stop category (EN 60204-1), where the stop is requested."""
    answer: str = ""
    """Reaction of the bridge, or of the drives."""
    remains: str = "-"
    """Remaining task of the user."""


_RAMP: Final = "ramp"
WATCH: Final = "each drive stops by its heartbeat consumer; then no power"
ON_A_SLOPE: Final = "on a slope the robot then rolls: brakes"
_POWER_OFF: Final = "ramp, then no power if it does not roll"


def _requested(
    name: str, order: Callable[[TestOperator], None] | None, category: int, answer: str, **row: Any
) -> Cause:
    return Cause(name=name, order=order, category=category, answer=answer, worst_of=WORST_OF, **row)


REQUESTED: Final = (
    _requested("stick to neutral", TestOperator.returns_to_neutral, 2, _RAMP, lines=EVERY),
    _requested("pause", lambda hand: hand.does(pause=True), 2, _RAMP, reports=("operation paused",)),
    _requested("disarm", TestOperator.disarms, 2, _RAMP, lines=EVERY, reports=("not armed",)),
    _requested(
        "emergency stop",
        TestOperator.stops,
        1,
        f"{_POWER_OFF}; latched",
        lines=EVERY,
        reports=("emergency stop",),
    ),
    _requested(
        "termination",
        lambda hand: hand.does(terminate=True),
        1,
        "as the emergency stop, cannot be cleared",
        reports=("emergency stop",),
    ),
    _requested(
        "forced disarm",
        lambda hand: hand.does(force_disarm=True),
        1,
        "quick stop, then no power, also on a slope",
        lines=EVERY,
        reports=("not armed",),
        remains=ON_A_SLOPE,
    ),
    _requested("end of the program", None, 1, _POWER_OFF, lines=EVERY, fault=fault("bridge_ends")),
)
"""Requested stops."""

LINK_DEAD: Final = Cause(
    name="operator link dead",
    fault=fault("datagram_loss"),
    lines=EVERY,
    worst_of=WORST_OF,
    reports=("operator link timeout",),
    answer=_RAMP,
)
KILLED: Final = Cause(
    name="bridge killed",
    fault=fault("bridge_ends", how="killed"),
    lines=EVERY,
    worst_of=WORST_OF,
    answer=WATCH,
    remains=ON_A_SLOPE,
)
LINE_CUT: Final = Cause(
    name="line cut",
    fault={
        "can": fault("node_silent", node="bridge"),
        "serial": fault("serial_unplugged"),
        "board": fault("board_silent"),
    },
    lines=EVERY,
)
COMMON: Final = (
    LINK_DEAD,
    KILLED,
    LINE_CUT,
    Cause(
        name="board or drive reset",
        fault={
            "can": hits("drive_restart", for_s=0.3),
            "serial": hits("drive_restart", for_s=0.3),
            "board": fault("board_reset"),
        },
        lines=EVERY,
    ),
    Cause(
        name="encoder off",
        fault={
            "can": hits("encoder_cut"),
            "serial": hits("encoder_cut"),
            "board": hits("encoder_cable_off"),
        },
        lines=tuple(line for line in EVERY if line != "ar2"),
    ),
    Cause(name="board hangs", fault=fault("board_hangs"), lines=ON_BOARDS),
    Cause(name="line cut for 3.5 s", fault=fault("board_silent", for_s=3.5), lines=ON_BOARDS),
)
"""Faults of every robot."""
