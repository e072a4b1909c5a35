"""What stops RARS, asked for or failing: a row each, with how it begins and what has to notice it.

`drive.py` drives them, `measured.csv` keeps the worst that came of it, and `docs/safety.md` shows both.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Any, Final

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
    then: Mapping[str, float] = field(default_factory=dict)
    """What the operator asks for right after such a failure: at rest an axis shows little."""
    lifts: bool = False
    """Whether the way that counts is the lift's."""


AHEAD: Final = Motion("ahead at 0.5 m/s", {"speed_mps": 0.5}, "left")
BACK: Final = Motion("backwards at 0.5 m/s", {"speed_mps": -0.5}, "right")
TURNING: Final = Motion(
    "at 0.4 m/s in a turn", {"speed_mps": 0.4, "steer_deg": 12.0}, "steer", then={"steer_deg": -12.0}
)
LIFTING: Final = Motion("lifting at 0.1 m/s", {"lift_rate_mps": 0.1}, "lift", lifts=True)
MOTIONS: Final = (AHEAD, BACK, TURNING, LIFTING)
LETS_GO: Final = {"speed_mps": 0.0, "steer_deg": 0.0, "lift_rate_mps": 0.0}
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
    also: Mapping[str, object] = field(default_factory=dict)
    """What the operator does at that instant, where the failure shows by it."""
    links: tuple[str, ...] = LINKS
    motions: tuple[Motion, ...] = MOTIONS
    tells: tuple[str, ...] = ()
    """One of these holds begins, by how its name begins; empty: the order is its own word, or nobody is left
    to tell."""
    category: int | None = None
    """Of the stop (EN 60204-1), where it is one that somebody asks for."""
    answer: str
    """What the bridge, or the drives, do."""
    remains: str = "-"
    """What is left to the user."""


_RAMP: Final = "ramp"
_WATCH: Final = "each drive stops by its own watch, and has no power then"
_ONE_OFF: Final = "that drive has no power, the others ramp"
_ESCALATES: Final = "the others ramp; that one by the next step, and the next"
_ON_A_SLOPE: Final = "on a slope it rolls then: brakes"
_ROLLS_OUT: Final = "that axis rolls out, or drops what it holds: brakes"

ASKED: Final = (
    Cause(name="stick let go", by=By.OPERATOR, how=LETS_GO, category=2, answer=_RAMP),
    Cause(name="pause", by=By.OPERATOR, how={"pause": True}, tells=("paused",), category=2, answer=_RAMP),
    Cause(
        name="disarm", by=By.OPERATOR, how={"disarm": True}, tells=("not armed",), category=2, answer=_RAMP
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
        remains=_ON_A_SLOPE,
    ),
    Cause(
        name="end of the program",
        by=By.PROGRAM,
        what="ends",
        category=1,
        answer="ramp, then no power where it stands by itself",
    ),
)
"""Somebody asks for it."""


def _fault(name: str, kind: str, answer: str, tells: str, **row: Any) -> Cause:
    return Cause(name=name, by=By.FAULT, what=kind, answer=answer, tells=tuple(tells.split(", ")), **row)


_FAULT: Final = "axis fault"
_SILENT: Final = "axis silent"
_GONE: Final = "axis silent, axis not enabled, axis zero lost, axis restarted"
_MASTER: Final = "another master, axis not enabled, axis silent, axis fault, axis zero lost, axis restarted"
_BELIEF: Final = "axis fault, axis does not follow, axis moves unasked, axis position repeats"

FAILS: Final = (
    _fault("operator's link dead", "datagram_loss", _RAMP, "operator silent"),
    _fault(
        "operator's words late by 0.6 s",
        "datagram_late",
        "ramp; held while they are so old",
        "operator silent, word too old",
        how={"by_ms": 600.0},
    ),
    Cause(name="bridge's process dead", by=By.PROGRAM, what="dies", answer=_WATCH, remains=_ON_A_SLOPE),
    _fault("bridge off the bus", "node_silent", _WATCH, _SILENT, how={"node": "bridge"}, remains=_ON_A_SLOPE),
    _fault(
        "serial adapter unplugged", "serial_unplugged", _WATCH, "link lost", links=SERIAL, remains=_ON_A_SLOPE
    ),
    _fault(
        "cable cut before all drives",
        "can_cut",
        _WATCH,
        _SILENT,
        how={"between": ["bridge", "left"]},
        links=CAN,
        remains=_ON_A_SLOPE,
    ),
    _fault(
        "cable cut behind one drive",
        "can_cut",
        "the drives beyond it stop by their own watch, that one is stopped",
        _SILENT,
        how={"between": ["left", "right"]},
        remains=_ON_A_SLOPE,
    ),
    _fault("wires of one drive swapped", "can_swapped", _WATCH, f"{_SILENT}, {_FAULT}", hits=True),
    _fault(
        "a node that babbles",
        "babbling_node",
        _WATCH,
        f"{_SILENT}, {_FAULT}, axis answers late",
        how={"every_us": 100},
    ),
    _fault("all frames of one drive damaged", "frame_error", _ESCALATES, f"{_SILENT}, {_FAULT}", hits=True),
    _fault(
        "one drive hears no frame whole", "reception_error", _ESCALATES, f"{_SILENT}, {_FAULT}", hits=True
    ),
    _fault("one drive's frames are lost", "frame_loss", _ESCALATES, _SILENT, hits=True),
    _fault("one drive misses frames", "receive_overrun", _ESCALATES, f"{_SILENT}, {_FAULT}", hits=True),
    _fault("one drive off the bus", "bus_off", _ESCALATES, _SILENT, hits=True),
    _fault("one drive's cables out", "node_silent", _ESCALATES, _SILENT, hits=True),
    _fault("one drive restarts", "drive_restart", _ONE_OFF, _GONE, hits=True, remains=_ROLLS_OUT),
    _fault(
        "a stranger stops a drive's process data",
        "nmt_stranger",
        _ESCALATES,
        _MASTER,
        hits=True,
        how={"command": "stop"},
    ),
    _fault(
        "a stranger resets a drive",
        "nmt_stranger",
        _ONE_OFF,
        _MASTER,
        hits=True,
        how={"command": "reset_node"},
        remains=_ROLLS_OUT,
    ),
    _fault(
        "a stranger resets a drive's communication",
        "nmt_stranger",
        _ESCALATES,
        _MASTER,
        hits=True,
        how={"command": "reset_communication"},
    ),
    _fault(
        "one drive ignores set-points",
        "set_points_ignored",
        _ESCALATES,
        _BELIEF,
        hits=True,
        also=LETS_GO,
        motions=(AHEAD, BACK, TURNING),  # the lift's last target is near
    ),
    _fault(
        "one drive's supply too low",
        "supply_sag",
        _ONE_OFF,
        _FAULT,
        hits=True,
        how={"to_v": 5.0},
        remains=_ROLLS_OUT,
    ),
    _fault(
        "all drives' supply too low",
        "supply_sag",
        "no drive has power",
        _FAULT,
        how={"to_v": 5.0},
        remains="the robot rolls out: brakes",
    ),
    _fault("one encoder's cable out", "encoder_cut", _ONE_OFF, _FAULT, hits=True, remains=_ROLLS_OUT),
    _fault(
        "one encoder's channels swapped", "encoder_swapped", _ONE_OFF, _BELIEF, hits=True, remains=_ROLLS_OUT
    ),
    _fault(
        "one encoder loses half its counts",
        "encoder_counts_lost",
        _ONE_OFF,
        _BELIEF,
        hits=True,
        how={"share": 0.5},
        remains=_ROLLS_OUT,
    ),
    _fault(
        "one encoder stands",
        "encoder_frozen",
        "that drive's power is taken, the others ramp",
        _BELIEF,
        hits=True,
        remains=_ROLLS_OUT,
    ),
)
"""Something fails, at one axis that moves or for all."""

CAUSES: Final = (*ASKED, *FAILS)


@dataclass(frozen=True, slots=True)
class Told:
    """What else goes wrong, where no way tells what matters; a test tells it as a story."""

    name: str
    noticed: str
    answer: str
    test: str


STORIES: Final = (
    Told(
        "another master drives the disarmed robot",
        "another master; axis moves unasked",
        "power taken within 0.5 s, and with each of the bridge's frames",
        "test_another_master_does_not_drive_a_disarmed_robot_for_long",
    ),
    Told(
        "a second bridge is started",
        "its own: somebody else sends",
        "it sends nothing, and ends",
        "test_a_second_bridge_refuses_to_start_and_says_why",
    ),
    Told(
        "a drive has lost its zero with the lift up",
        "axis zero lost",
        "no arming before somebody has said where it stands",
        "test_a_raised_lift_that_restarts_is_believed_where_somebody_saw_it",
    ),
    Told(
        "a wrong zero is confirmed",
        "-: it is believed within the travel",
        "none: look twice",
        "test_a_raised_lift_that_restarts_is_believed_where_somebody_saw_it",
    ),
    Told(
        "the battery is low",
        "battery low",
        "ramp, no arming",
        "test_a_battery_that_stays_low_stops_the_robot_and_lets_nobody_arm",
    ),
    Told(
        "another station joins in",
        "control: told",
        "who does not drive is not listened to, but for an emergency stop",
        "test_a_second_station_takes_nothing_from_who_drives",
    ),
    Told(
        "somebody forges an emergency stop",
        "emergency stop",
        "obeyed: the robot stands, and who drives clears it",
        "test_anybodys_emergency_stop_is_obeyed_and_only_the_driver_clears_it",
    ),
    Told(
        "a crowd floods the operator's link",
        "-",
        "who drives is heard and answered first",
        "test_a_crowd_that_beats_does_not_starve_who_drives",
    ),
    Told(
        "an emergency stop on a slope",
        "held with power",
        "power kept until it is ordered off",
        "test_an_emergency_stop_ends_without_power_where_the_robot_stands_by_itself",
    ),
    Told(
        "the bridge dies on a slope",
        "by the drives",
        "it stops, then rolls: brakes",
        "test_a_bridge_that_dies_on_a_slope_leaves_the_robot_to_roll",
    ),
    Told(
        "nothing reaches a drive any more",
        "reset unconfirmed",
        "told; the emergency stop switch of the robot",
        "test_where_nothing_helps_the_operator_and_the_program_say_so",
    ),
)

ALIKE: Final = {
    "supply_surge": "supply_sag",
    "logic_supply_sag": "supply_sag",
    "gate_supply_sag": "supply_sag",
    "overheating": "supply_sag",
}
"""Kinds of faults that take one drive's power at once, as another one does."""

ELSEWHERE: Final = {
    "bridge_ends": "the rows of the program",
    "second_bridge": "a story",
    "second_station": "a story",
    **dict.fromkeys(
        (
            "board_silent",
            "board_reset",
            "board_hangs",
            "motor_cable_off",
            "encoder_cable_off",
            "shaft_blocked",
            "load_lifted",
            "motor_supply_sag",
            "motor_leads_swapped",
            "board_chatters",
            "i2c_stuck",
            "shield_absent",
        ),
        "ROME's stories",
    ),
    **dict.fromkeys(
        ("board_brown_out", "line_garbage", "capture_late", "capture_loss"), "the adversary's evenings"
    ),
    **dict.fromkeys(("body_hidden", "body_shakes", "markers_swapped"), "stories of robots that cameras see"),
    "grip_lost": "the climber's stories",
    "stray_frames": "a story: another master",
    "datagram_doubled": "nothing has to stop: a command counts once",
    "index_missing": "nothing has to stop: no drive of RARS watches the index",
    "index_spurious": "nothing has to stop: no drive of RARS watches the index",
}
"""Kinds of faults that are no cause here, and why."""
