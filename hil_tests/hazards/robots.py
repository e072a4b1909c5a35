"""Functions that a robot type brings: each with the hazard that it is for."""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.robot import AnyRobot
from hil_tests.hazards.rows import Function

PLANE: Final = "steps, holes and slopes reduce the margin"
TIRES: Final = "tires that slip: the robot is faster than its wheels"
CARRIED: Final = "a robot that is carried elsewhere while the cameras do not see it"


def _delay(robot: AnyRobot) -> str:
    agreed = robot.operator.agreed_ms
    if agreed is None:
        return f"a session that agrees on a larger age than {robot.operator.max_age_ms} ms"
    return f"{agreed} ms agreed: {robot.operator.speed_share:.0%} of the top speed"


DELAY: Final = Function(
    "delay limit",
    "the operator agrees to drive with a longer delay, and sees obstacles later",
    "the operator has to drive as slowly as the picture takes",
    _delay,
    "hil_tests/safety/test_gate_limits.py"
    "::test_the_delay_limit_names_both_ages_and_is_shown_for_300_milliseconds",
)
ACCELERATION: Final = Function(
    "acceleration limit", "a sudden command tips the robot or makes its wheels slip", PLANE
)
SPEED: Final = Function("speed limit", "the robot is too fast to be stopped in time", TIRES)
TURN: Final = Function("turn rate limit", "the robot turns faster than people expect", TIRES)

MASSES: Final = "masses and places of the load are those of the robot file; bumps are not detected"
RARS: Final = (
    Function("steer angle unknown", "the robot drives where no one commanded: its steering is unknown", "-"),
    Function("lift height unknown", "the robot drives with a raised load: its height is unknown", "-"),
    Function(
        "tilt unknown",
        "the robot drives or lifts on a slope that no one measures",
        "a robot file without an IMU",
    ),
    Function(
        "load implausible",
        "the robot tips under a load that is heavier than stated",
        "found only while it drives on a slope; a robot file without the table for it",
    ),
    Function("lift extended", "a robot with a raised load tips when it drives", PLANE),
    Function("lift moving", "base and lift move together, and the load sways", PLANE),
    Function("lift refused", "the lift rises while the robot drives", PLANE),
    SPEED,
    Function("tipping limit", "the robot tips in a turn", PLANE),
    Function("steer angle limit", "the steering runs into its end", "-"),
    Function("turn radius limit", "the robot turns more tightly than its steering keeps", "-"),
    Function("lift rate limit", "the load rises too fast", "people below or beside it are not detected"),
    Function("lift range limit", "the lift runs into its end", "a wrong reference that is confirmed"),
    Function("lift margin limit", "a raised load tips the robot on a slope", MASSES),
    Function("margin limit", "the robot tips as it starts, turns or stops on a slope", MASSES),
    ACCELERATION,
)
SERVO_AXIS: Final = (
    Function("position unknown", "the axis goes where no one commanded: its position is unknown", "-"),
    Function(
        "axis outside",
        "the axis is where it can hit its stop, or people beside it",
        "a wrong reference that is confirmed",
    ),
    Function("speed limit", "the axis is too fast for people near it", "people are not detected"),
    Function("travel limit", "the axis runs into its end", "a wrong reference that is confirmed"),
    Function("acceleration limit", "a sudden command throws what the axis carries", "-"),
)
ROME: Final = (
    Function(
        "base slips",
        "a wheel is blocked, lifted or without its motor, and the base goes elsewhere",
        "needs cameras: without them such a wheel goes unnoticed where its encoder is not read",
    ),
    Function("pose lost", "a path follower drives by a pose that is wrong", CARRIED),
    Function(
        "turns too fast", "a wheel runs away, and the base spins", "half as much again is reached first"
    ),
    SPEED,
    TURN,
    Function("rim limit", "a wheel cannot turn as fast as commanded, and the base goes elsewhere", TIRES),
    ACCELERATION,
)
AR2: Final = (
    Function(
        "tool outside",
        "the tool is where it can hit floor, base or people",
        "steps that are lost: no encoder",
    ),
    Function("tool speed limit", "the tool is too fast for people near it", "people are not detected"),
    Function("tool turn limit", "the tool turns too fast for what it carries", "-"),
    Function(
        "workspace",
        "the tool hits the floor, its own base, or what stands around",
        "what stands inside the workspace is not known",
    ),
    Function(
        "joint limit",
        "a joint runs into its end, or is commanded faster than its motor steps",
        "steps that are lost: no encoder",
    ),
    Function(
        "acceleration limit", "a sudden command makes a motor lose steps", "steps that are lost: no encoder"
    ),
)
CLIMBER: Final = (
    Function("off the wall", "a magnet lets go, and the robot falls", "it falls in any case: a tether"),
    Function("robot slips", "the wheels slip, and the robot slides down", "needs cameras"),
    Function("pose lost", "a path follower drives by a pose that is wrong", CARRIED),
    Function(
        "turns too fast",
        "a wheel runs away, and the robot turns off its path",
        "a third as much again is reached first",
    ),
    SPEED,
    Function("joint limit", "the joint folds up to its stops, and a wheel leaves the wall", "-"),
    Function("coupled wheels", "a turn is commanded that one shaft cannot drive", "-"),
    Function(
        "place unknown",
        "the robot is driven before its height is known",
        "without cameras its height is by odometry from `[geometry.start]`",
    ),
    Function(
        "height limit",
        "the robot leaves the tank at its edge",
        "a wrong `[geometry.start]`, where no cameras see it",
    ),
    Function(
        "adhesion limit",
        "the hanging cable becomes heavier than the magnets hold",
        "paint and dirt",
    ),
    Function("cable limit", "the cable becomes taut and pulls the robot off", "what the cable is caught by"),
    TURN,
    Function("sideways limit", "the robot slips sideways in a turn", TIRES),
    ACCELERATION,
)


def _of_the_arm(row: Function) -> Function:
    """Return a function of the arm by its name on a robot that has a base, too."""
    name = row.name if row.name.startswith("tool ") else f"tool {row.name}"
    return Function(name, row.hazard, row.residual, row.trips, row.test, row.causes, row.reaction)


ROME_ARM: Final = (
    *ROME,
    *map(_of_the_arm, AR2),
    Function("arm out", "the base drives with its arm out, and tips or hits", PLANE),
    Function("off balance", "the robot tips at rest", f"{PLANE}; a load that is not in the robot file"),
    Function("tool balance", "the arm moves the center of gravity beyond the wheels", PLANE),
    Function(
        "time stretched",
        "a path requires more than base and arm can do, and they part",
        "-",
        reaction="the path takes longer; reported",
    ),
)
OWN: Final[Mapping[str, tuple[Function, ...]]] = {
    "rars": (*RARS, DELAY),
    "rome": (*ROME, DELAY),
    "ar2": (*AR2, DELAY),
    "servo_axis": (*SERVO_AXIS, DELAY),
    "climber": (*CLIMBER, DELAY),
    "rome_arm": (*ROME_ARM, DELAY),
}
