"""Faults of RARS, at one axis that moves or for all, a row each, and those that other tests show."""

from dataclasses import dataclass
from typing import Any, Final

from hil_tests.failures.causes import (
    AHEAD,
    BACK,
    CAN,
    KILLED,
    LINK_DEAD,
    ON_A_SLOPE,
    SERIAL,
    TURNING,
    WATCH,
    WORST_OF,
    Cause,
    Fault,
    fault,
    hits,
)

_ONE_OFF: Final = "that drive has no power, the others ramp"
_ESCALATES: Final = "the others ramp; that one by the next stop stages"
_ROLLS_OUT: Final = "that axis coasts, or drops its load: brakes"
_FAULT: Final = ("axis fault",)
_SILENT: Final = ("axis timeout",)
_SILENT_OR_FAULT: Final = ("axis timeout", "axis fault")
_GONE: Final = ("axis timeout", "axis not enabled", "reference lost", "axis restarted")
_MASTER: Final = ("second controller", "axis fault", *_GONE)
_BELIEF: Final = ("axis fault", "tracking error", "uncommanded motion", "position not changing")


def _fails(name: str, what: Fault, answer: str, reports: tuple[str, ...], **row: Any) -> Cause:
    return Cause(name=name, fault=what, answer=answer, reports=reports, **{"worst_of": WORST_OF, **row})


def _rolls(name: str, what: Fault, reports: tuple[str, ...], answer: str = _ONE_OFF) -> Cause:
    return _fails(name, what, answer, reports, remains=_ROLLS_OUT)


FAILS: Final = (
    LINK_DEAD,
    _fails(
        "operator's messages late by 0.6 s",
        fault("datagram_late", by_ms=600.0),
        "ramp; `command stale` while they are too old",
        ("operator link timeout", "command stale"),
    ),
    KILLED,
    _fails("bridge off the bus", fault("node_silent", node="bridge"), WATCH, _SILENT, remains=ON_A_SLOPE),
    _fails(
        "serial adapter unplugged",
        fault("serial_unplugged"),
        WATCH,
        ("link lost",),
        on=SERIAL,
        remains=ON_A_SLOPE,
    ),
    _fails(
        "cable cut before all drives",
        fault("can_cut", between=["bridge", "left"]),
        WATCH,
        _SILENT,
        on=CAN,
        remains=ON_A_SLOPE,
    ),
    _fails(
        "cable cut behind one drive",
        fault("can_cut", between=["left", "right"]),
        "the drives behind the cut stop by their heartbeat consumers, the first is stopped",
        _SILENT,
        remains=ON_A_SLOPE,
    ),
    _fails("wires of one drive swapped", hits("can_swapped"), WATCH, _SILENT_OR_FAULT),
    _fails(
        "a babbling node",
        fault("babbling_node", every_us=100),
        WATCH,
        (*_SILENT_OR_FAULT, "late answer"),
    ),
    _fails("all frames of one drive damaged", hits("frame_error"), _ESCALATES, _SILENT_OR_FAULT),
    _fails("one drive receives no whole frame", hits("reception_error"), _ESCALATES, _SILENT_OR_FAULT),
    _fails("one drive's frames are lost", hits("frame_loss"), _ESCALATES, _SILENT),
    _fails("one drive misses frames", hits("receive_overrun"), _ESCALATES, _SILENT_OR_FAULT),
    _fails("one drive off the bus", hits("bus_off"), _ESCALATES, _SILENT),
    _fails("one drive's cables out", hits("node_silent"), _ESCALATES, _SILENT),
    _rolls("one drive restarts", hits("drive_restart"), _GONE),
    _fails(
        "a second controller stops a drive's process data",
        hits("nmt_foreign_node", command="stop"),
        _ESCALATES,
        _MASTER,
    ),
    _rolls("a second controller resets a drive", hits("nmt_foreign_node", command="reset_node"), _MASTER),
    _fails(
        "a second controller resets a drive's communication",
        hits("nmt_foreign_node", command="reset_communication"),
        _ESCALATES,
        _MASTER,
    ),
    _fails(
        "one drive ignores set-points",
        hits("set_points_ignored"),
        _ESCALATES,
        _BELIEF,
        returns_to_neutral=True,
        worst_of=(AHEAD, BACK, TURNING),  # the lift's last target is near
    ),
    _rolls("one drive's supply too low", hits("supply_sag", to_v=5.0), _FAULT),
    _fails(
        "all drives' supply too low",
        fault("supply_sag", to_v=5.0),
        "no drive has power",
        _FAULT,
        remains="the robot coasts: brakes",
    ),
    _rolls("one encoder's cable out", hits("encoder_cut"), _FAULT),
    _rolls("one encoder's channels swapped", hits("encoder_swapped"), _BELIEF),
    _rolls("one encoder loses half its counts", hits("encoder_counts_lost", share=0.5), _BELIEF),
    _rolls(
        "one encoder stuck",
        hits("encoder_frozen"),
        _BELIEF,
        "that drive's power stage is disabled, the others ramp",
    ),
)
"""Each at the worst of RARS's motions."""


@dataclass(frozen=True, slots=True)
class Shown:
    """A fault for which no distance is meaningful: a test of its own shows its effect."""

    name: str
    noticed: str
    answer: str
    test: str


SHOWN: Final = (
    Shown(
        "a second controller drives the disarmed robot",
        "second controller; uncommanded motion",
        "power stage disabled within 0.5 s, and again with each of the bridge's frames",
        "test_another_master_does_not_drive_a_disarmed_robot_for_long",
    ),
    Shown(
        "a second bridge is started",
        "by the second bridge: other traffic",
        "it sends nothing, and exits",
        "test_a_second_bridge_refuses_to_start_and_states_why",
    ),
    Shown(
        "a drive has lost its reference with the lift up",
        "reference lost",
        "no arming before its position is confirmed",
        "test_a_raised_lift_that_restarts_is_believed_where_someone_saw_it",
    ),
    Shown(
        "a wrong position is confirmed",
        "-: accepted within the travel",
        "none: check before confirming",
        "test_a_raised_lift_that_restarts_is_believed_where_someone_saw_it",
    ),
    Shown(
        "the battery is low",
        "battery low",
        "ramp, no arming",
        "test_a_battery_that_stays_low_stops_the_robot_and_lets_no_one_arm",
    ),
    Shown(
        "another station joins in",
        "control: reported",
        "only its emergency stop is accepted",
        "test_a_second_station_takes_nothing_from_who_drives",
    ),
    Shown(
        "a forged emergency stop",
        "emergency stop",
        "accepted: the robot stops, and the station in control clears it",
        "test_anybodys_emergency_stop_is_obeyed_and_only_the_driver_clears_it",
    ),
    Shown(
        "many stations flood the operator's link",
        "-",
        "the station in control is served first",
        "test_a_crowd_that_beats_does_not_starve_who_drives",
    ),
    Shown(
        "an emergency stop on a slope",
        "held with power",
        "power kept until a power-off command",
        "test_an_emergency_stop_ends_without_power_where_the_robot_stands_by_itself",
    ),
    Shown(
        "the bridge dies on a slope",
        "by the drives",
        "it stops, then rolls: brakes",
        "test_a_bridge_that_dies_on_a_slope_leaves_the_robot_to_roll",
    ),
    Shown(
        "a drive receives nothing any more",
        "stop not acknowledged",
        "reported; the emergency stop switch of the robot",
        "test_where_nothing_helps_the_operator_and_the_program_say_so",
    ),
)

ELSEWHERE: Final = {
    "drive_variation": "tests of the CiA 402 drives: another drive from its power-on, and no failure",
    **dict.fromkeys(
        ("bridge_suspended", "second_bridge", "second_station", "stray_frames"), "a test of its own"
    ),
    **dict.fromkeys(
        ("load_lifted", "board_chatters", "i2c_stuck", "shield_absent", "current_limit", "over_temperature"),
        "tests of the board and its wiring",
    ),
    **dict.fromkeys(
        ("board_brown_out", "board_unpowered", "line_garbage", "capture_late", "capture_loss"),
        "the adversary's random runs",
    ),
    **dict.fromkeys(("body_hidden", "body_shakes", "markers_swapped"), "tests of robots that cameras see"),
    **dict.fromkeys(("imu_frozen", "imu_axes_swapped", "imu_silent"), "tests of the IMU"),
    "grip_lost": "a test of the climber",
}
"""Kinds of faults that are no cause here, and why."""
