"""Functions on each axis: interlocks by what its device reports, and the weaker ones in their place."""

from typing import Final

from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.common import HALTS
from firmware_bridge.safety.tracking import within
from firmware_bridge.units import MILLISECOND
from hil_tests.hazards.common import BRAKES, SCENARIOS, always, each_link
from hil_tests.hazards.rows import Function

WEAKER: Final = "hil_tests/safety/test_weaker_rows.py"
PLAUSIBLE: Final = f"{SCENARIOS}/test_plausibility_stories.py"
COASTS: Final = "an axis without power coasts, or drops its load: brakes"


def _within(robot: AnyRobot) -> str:
    """Return the time that an axis may deviate; several where the axes differ."""
    times = {within(axis, robot.links[axis.link].silent_ms * MILLISECOND) for axis in robot.axes}
    return " or ".join(f"{time // MILLISECOND} ms" for time in sorted(times))


def _deviates(robot: AnyRobot) -> str:
    return f"outside of its plausibility limits, see below, for {_within(robot)}"


def _stands(robot: AnyRobot) -> str:
    turned = f"{HALTS // MILLISECOND} ms where it turned"
    return f"the same position to the last bit for {_within(robot)}, {turned}, while it is commanded to move"


AXES: Final = (
    Function(
        "axis timeout",
        "a device does not report any more, and its state is unknown",
        "it moves on for this time; a device that receives nothing stops by its watchdog",
        each_link(lambda link: f"{link.silent_ms} ms without a report"),
        "hil_tests/safety/test_gate_lift.py::test_at_the_deadline_a_silence_trips_and_not_before",
        (
            "one drive off the bus",
            "one drive's cables out",
            "one drive's frames are lost",
            "all frames of one drive damaged",
            "wires of one drive swapped",
            "cable cut behind one drive",
            "board hangs",
        ),
        "the others stop by the ramp, this axis by the stop stages; disarmed",
    ),
    Function(
        "axis fault",
        "a device has failed, and has no torque",
        COASTS,
        always("a fault code or a fault state, in the cycle in which it comes"),
        f"{SCENARIOS}/test_sensor_stories.py::test_a_wheel_whose_encoder_is_cut_off_stops_the_robot",
        (
            "one drive's supply too low",
            "all drives' supply too low",
            "one encoder's cable out",
            "encoder off",
        ),
        "the others stop by the ramp, this axis has no torque; disarmed",
    ),
    Function(
        "axis reconfigured",
        "another program changes a device's parameters",
        "not detected on a serial line",
        always("a write to one of its objects by another program, as it is seen on the bus"),
        f"{SCENARIOS}/test_stop_stories.py"
        "::test_a_drive_that_someone_else_has_written_to_stops_and_is_set_up_again",
    ),
    Function(
        "axis not enabled",
        "an axis has lost its power stage, and the others go on",
        COASTS,
        always("a statusword that is not operation enabled, in the cycle in which it comes"),
        f"{SCENARIOS}/test_serial_drive.py"
        "::test_a_drive_that_restarts_behind_the_gateway_is_noticed_and_set_up_again",
        ("one drive restarts", "board or drive reset"),
        "the others stop by the ramp, this axis has no torque; disarmed",
    ),
    Function(
        "late answer",
        "an axis has lost its power, and its device cannot report it",
        "a motor driver without power on a board that answers",
        each_link(lambda link: f"{link.silent_ms // 2} ms without an answer"),
        f"{WEAKER}::test_the_weaker_row_wants_an_answer_within_half_the_silence",
        ("board or drive reset", "board hangs", "line cut"),
    ),
    Function(
        "reference lost",
        "a position is wrong, and the axis runs into its end",
        "a wrong position that is confirmed",
        always("a device that has restarted, or was never referenced"),
        f"{SCENARIOS}/test_zero_stories.py"
        "::test_a_raised_lift_that_restarts_is_believed_where_someone_saw_it",
    ),
    Function(
        "axis restarted",
        "a position is wrong, and the axis runs into its end",
        "a wrong position that is confirmed; a restart that the device does not report",
        always("the bridge's start, and a restart that the device reports"),
        f"{SCENARIOS}/test_ar2_stories.py"
        "::test_after_a_reset_nothing_moves_until_someone_has_stated_where_it_stands",
        ("board or drive reset",),
    ),
    Function(
        "tracking error",
        "an axis does not do what it is commanded",
        f"a deviation within the limits; {BRAKES}",
        _deviates,
        f"{PLAUSIBLE}::test_a_drive_that_ignores_a_speed_does_not_follow",
        ("one drive ignores set-points",),
    ),
    Function(
        "uncommanded motion",
        "an axis moves without a command, or against it",
        COASTS,
        _deviates,
        f"{PLAUSIBLE}::test_a_drive_that_ignores_its_set_points_moves_uncommanded",
        ("one encoder's channels swapped", "one encoder loses half its counts", "encoder off"),
    ),
    Function(
        "position not changing",
        "an encoder is off or an axis is blocked, and its regulator increases the current",
        f"an axis that is commanded to stand shows nothing; {COASTS}",
        _stands,
        "hil_tests/unit/fmea/test_fmea.py"
        "::test_an_encoder_that_freezes_while_the_robot_is_stopped_does_not_run_away_unseen",
        ("one encoder stuck", "encoder off"),
    ),
    Function(
        "no feedback",
        "an axis does not do what it is commanded, and its device measures no motion",
        "a motor that stands, slips or turns without a command goes unnoticed: only cameras detect it",
        each_link(lambda link: f"{link.silent_ms // 2} ms without an answer"),
        f"{WEAKER}::test_who_does_not_report_how_it_moves_answers_within_half_the_silence",
        ("board or drive reset", "board hangs", "line cut"),
    ),
    Function(
        "axis excluded",
        "an axis that a mode does without has power",
        "-",
        always("a power stage that is enabled, in the cycle in which it is reported"),
        "hil_tests/unit/pipeline/test_modes_and_path_followers.py"
        "::test_while_it_has_power_the_robot_is_held_by_a_row_of_its_own",
    ),
)
