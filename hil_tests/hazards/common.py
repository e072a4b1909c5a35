"""Functions that every robot has: the operator, the links, the bridge itself."""

from collections.abc import Callable
from typing import Final

from firmware_bridge.canopen_drive.settings import DriveLink
from firmware_bridge.drivers.all_drivers import alone
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.operator_link import OperatorLink
from firmware_bridge.robot.table import LinkTable
from hil_tests.hazards.rows import Function, Trips

SCENARIOS: Final = "hil_tests/scenarios"
BRAKES: Final = "a robot without power rolls on a slope: brakes"


def operator(text: Callable[[OperatorLink], str]) -> Trips:
    """Return the text for the operator's table of a robot."""
    return lambda robot: text(robot.operator)


def each_link(text: Callable[[LinkTable], str]) -> Trips:
    """Return the text for each link that axes are on; once where it is the same for all."""

    def trips(robot: AnyRobot) -> str:
        found = {name: text(link) for name, link in robot.links.items() if robot.axes_on(name)}
        if len(set(found.values())) == 1:
            return next(iter(found.values()))
        return "; ".join(f"`{name}`: {one}" for name, one in found.items())

    return trips


def always(text: str) -> Trips:
    """Return a text that is the same for every robot."""
    return lambda _: text


def _battery(robot: AnyRobot) -> str:
    battery = robot.battery
    if battery is None:
        return "never: the robot file names no battery sensor"
    return f"below {battery.low_v:g} V, at once while disarmed, for {battery.stops_after_s:g} s while armed"


def _not_timestamped(robot: AnyRobot) -> str:
    stated = robot.operator.unknown_age
    how = "by the station's key" if stated is None else f"`unknown_age` is {stated.value}"
    return f"a command that no clock dates, where that is refused: {how}"


def _look(robot: AnyRobot) -> str:
    times = {link.bridge_silent_ms for link in DriveLink.all_of(robot).values()}
    shown = " or ".join(f"{time} ms" for time in sorted(times))
    return f"another controller's frame within {shown} before the first frame is sent"


def _watchdogs(robot: AnyRobot) -> str:
    found = {name: alone(robot, name) for name in robot.links if robot.axes_on(name)}
    return "; ".join(
        f"`{name}`: {text or 'none: the motors keep running as commanded'}" for name, text in found.items()
    )


COMMON: Final = (
    Function(
        "emergency stop",
        "the operator, or a station that looks on, sees a danger that no interlock detects",
        "it needs a working radio, bridge and device: a switch in the power supply within reach",
        always("its command, from any station"),
        f"{SCENARIOS}/test_control_stories.py"
        "::test_anybodys_emergency_stop_is_obeyed_and_only_the_driver_clears_it",
        ("emergency stop", "termination"),
    ),
    Function(
        "bridge stalled",
        "the bridge's process stands still, and nothing is judged",
        "until the process runs again only the devices' watchdogs act",
        operator(lambda it: f"{it.silent_ms} ms without a cycle"),
        "hil_tests/processes/test_how_a_bridge_ends.py::test_the_robot_stands",
    ),
    Function(
        "link lost",
        "an adapter or its cable is out, and no device can be commanded",
        f"the devices stop by their watchdogs, where they have one; {BRAKES}",
        always("the adapter's report, in the same cycle"),
        f"{SCENARIOS}/test_serial_drive.py"
        "::test_an_adapter_that_is_unplugged_is_reported_within_a_cycle_and_needs_a_new_arm",
        ("line cut", "serial adapter unplugged", "line cut for 3.5 s"),
        "no command reaches its devices: their watchdogs stop them; disarmed",
    ),
    Function(
        "second controller",
        "another program commands the drives",
        "not detected on a serial line; a tool that reads and writes objects is no controller",
        always("one frame that only a master sends; it counts for 1 s"),
        f"{SCENARIOS}/test_stop_stories.py"
        "::test_another_master_stops_the_robot_and_blocks_arming_while_it_is_received",
        (
            "a second controller stops a drive's process data",
            "a second controller resets a drive",
            "a second controller resets a drive's communication",
        ),
    ),
    Function(
        "battery low",
        "the supply fails while the robot moves",
        "a supply that fails at once: the drives report it as a fault",
        _battery,
        "hil_tests/safety/test_gate_stops.py"
        "::test_a_low_battery_holds_at_once_while_disarmed_and_after_10_seconds_while_armed",
    ),
    Function(
        "not armed",
        "the robot moves before it is permitted",
        "the operator arms without looking",
        always("as long as the robot is not armed"),
        "hil_tests/robots/test_every_robot.py::test_nothing_moves_before_it_is_armed",
        ("disarm", "forced disarm"),
        "no axis is moved",
    ),
    Function(
        "operator link timeout",
        "the link to the operator fails while the robot moves",
        "it moves on for this time, and then over its stopping distance",
        operator(lambda it: f"{it.silent_ms} ms without a motion command"),
        f"{SCENARIOS}/test_rars_stories.py::test_a_silent_operator_brings_the_robot_to_rest",
        ("operator link dead",),
    ),
    Function(
        "command stale",
        "commands come late, and the operator reacts to a picture of the past",
        "a delay below the limit: the operator has to drive as slowly as it takes",
        operator(lambda it: f"a motion command that is {it.age_limit_ms} ms old when it comes"),
        f"{SCENARIOS}/test_age_stories.py"
        "::test_a_link_that_gets_slow_under_way_stops_the_robot_until_the_stick_is_let_go",
        ("operator's messages late by 0.6 s",),
    ),
    Function(
        "command not timestamped",
        "a command's age is unknown, and it may be old",
        "where unknown ages are accepted, only the operator link timeout protects",
        _not_timestamped,
        f"{SCENARIOS}/test_age_stories.py::test_where_unknown_is_refused_only_who_reports_his_age_drives",
    ),
    Function(
        "operator link lost",
        "no station is in control of an armed robot",
        "-",
        operator(lambda it: f"{it.lost_ms / 1000:g} s without a motion command"),
        "hil_tests/safety/test_gate_stops.py::test_at_its_threshold_it_stops_the_robot_and_states_why",
    ),
    Function(
        "stick not neutral",
        "the robot starts by itself when a link or a permission returns",
        "-",
        always("a control that is deflected when the operator's commands count again"),
        f"{SCENARIOS}/test_rars_stories.py"
        "::test_a_motion_returns_with_the_operator_once_the_stick_was_let_go",
        ("stick to neutral",),
    ),
    Function(
        "operation paused",
        "a robot that was paused moves",
        "-",
        always("its command, until it is taken back"),
        f"{SCENARIOS}/test_station_stories.py::test_offboard_drives_and_hold_stops_whatever_set_points_go_on",
        ("pause",),
    ),
    Function(
        "command unusable",
        "a station or a path follower sends what is no number",
        "-",
        always("a value that is NaN or infinite"),
        "hil_tests/robots/test_every_robot.py::test_a_command_that_is_no_number_stops_all_of_it",
    ),
)
"""Interlocks that judge no axis."""

BESIDE: Final = (
    Function(
        "stop stages",
        "a device does not carry out a stop",
        "a device that receives nothing any more: the switch in its supply",
        always("a stage that is not confirmed within its time, see the stop stages below"),
        f"{SCENARIOS}/test_stop_stories.py::test_where_nothing_helps_the_operator_and_the_program_say_so",
        ("one drive receives no whole frame", "one drive misses frames", "board hangs"),
        "the next stage, up to a reset; the operator is informed",
    ),
    Function(
        "output guard",
        "an error in the bridge or in a robot package commands too much",
        "an error within the bounds; the bounds are those of the robot file",
        always(
            "a set-point, a sum or a pair beyond its bound, see the output guard below; before it is sent"
        ),
        "hil_tests/safety/test_guard_alone.py::test_over_can_both_wheels_never_go_faster_than_the_base_may",
        (),
        "the safe demand is sent in its place",
    ),
    Function(
        "device watchdog",
        "the bridge dies, is killed or is cut off",
        f"firmwares without a watchdog keep driving; {BRAKES}",
        _watchdogs,
        "hil_tests/failures/test_failures.py::test_a_cause_has_the_outcome_that_was_measured",
        ("bridge killed", "bridge off the bus", "cable cut before all drives", "a babbling node"),
        "the devices stop by themselves; an EPOS2 disables its power stage then",
    ),
    Function(
        "look before start",
        "a second bridge takes the drives from the first",
        "not detected on a serial line",
        _look,
        f"{SCENARIOS}/test_stop_stories.py::test_a_second_bridge_refuses_to_start_and_states_why",
        (),
        "it sends nothing, and exits",
        lambda robot: bool(DriveLink.all_of(robot)),
    ),
    Function(
        "station in control",
        "two stations command one robot",
        "an emergency stop is accepted from everybody, forged ones too",
        always("a motion command of a station that is not in control"),
        f"{SCENARIOS}/test_control_stories.py::test_a_second_station_takes_nothing_from_who_drives",
        (),
        "the command is refused, and reported",
    ),
)
"""Functions that are no interlocks."""
