"""The AR2 in numbers: every parameter with unit and source.

[A] is Annin Robotics, AR2 and AR3: lengths, joints' limits and steps. What it does not give, motors and
masses, is assumed: orders of magnitude of the kind of motor, and links of an arm that fits on ROME's base.
"""

import math
from collections.abc import Mapping
from typing import Final, NamedTuple

from fmu.export.model import Parameter
from fmu.plants import Plant

AXES: Final = ("j1", "j2", "j3", "j4", "j5", "j6")


class Joint(NamedTuple):
    """A joint's limits in degrees, its steps between them and at rest, its motor and its link in SI."""

    least: float
    most: float
    steps: int
    rest: int
    holding: float
    rotor: float
    mass: float

    @property
    def gear(self) -> float:
        """Turns of the motor, of 400 half steps, for one of the joint."""
        return 360.0 * self.steps / (self.most - self.least) / 400.0

    @property
    def rest_rad(self) -> float:
        """Rest position of the joint."""
        return math.radians(self.least + self.rest * (self.most - self.least) / self.steps)


JOINTS: Final = (
    Joint(-170.0, 170.0, 15_200, 7_600, 0.45, 5.4e-6, 3.5),
    Joint(-132.0, 0.0, 7_300, 2_322, 1.16, 3.0e-5, 2.5),
    Joint(1.0, 141.0, 7_850, 0, 0.45, 5.4e-6, 2.0),
    Joint(-165.0, 165.0, 15_200, 7_600, 0.45, 5.4e-6, 1.0),
    Joint(-105.0, 105.0, 4_575, 2_287, 0.45, 5.4e-6, 0.5),
    Joint(-155.0, 155.0, 6_625, 3_312, 0.14, 1.2e-6, 0.3),
)


def _rows(axis: str, joint: Joint) -> tuple[Parameter, ...]:
    return (
        Parameter(f"gear_{axis}", joint.gear, "1", f"gear ratio, {axis}", "[A], steps per degree", least=0.0),
        Parameter(
            f"rest_{axis}", joint.rest_rad, "rad", f"angle at which field and rotor begin, {axis}", "[A]"
        ),
        Parameter(
            f"stop_low_{axis}",
            math.radians(joint.least - 1.0),
            "rad",
            f"lower stop, {axis}",
            "assumed, 1 degree behind [A]'s limit",
        ),
        Parameter(
            f"stop_high_{axis}",
            math.radians(joint.most + 1.0),
            "rad",
            f"upper stop, {axis}",
            "assumed, 1 degree behind [A]'s limit",
        ),
        Parameter(
            f"holding_{axis}",
            joint.holding,
            "N.m",
            f"motor's torque at rest, {axis}",
            "assumed, from memory",
            least=0.0,
        ),
        Parameter(
            f"rotor_inertia_{axis}", joint.rotor, "kg.m2", f"rotor, {axis}", "assumed, motors of this size"
        ),
        Parameter(
            f"mass_{axis}", joint.mass, "kg", f"link {axis}, at the middle between its frames", "assumed"
        ),
    )


PARAMETERS: Final[tuple[Parameter, ...]] = (
    *(row for axis, joint in zip(AXES, JOINTS, strict=True) for row in _rows(axis, joint)),
    Parameter("shoulder", 0.0642, "m", "first axis to the second", "[A], a of link 1", least=0.0),
    Parameter("height", 0.16977, "m", "floor to the second axis", "[A], d of link 1", least=0.0),
    Parameter("upper_arm", 0.305, "m", "second axis to the third", "[A], a of link 2", least=0.0),
    Parameter("forearm", 0.22263, "m", "third axis to the wrist's point", "[A], -d of link 4", least=0.0),
    Parameter("hand", 0.03625, "m", "wrist's point to the tool", "[A], -d of link 6", least=0.0),
    Parameter("payload", 0.0, "kg", "what the tool carries", "assumed, nothing", least=0.0, tunable=True),
    Parameter("gravity", 9.81, "m/s2", "standard gravity", "assumed", least=0.0),
    Parameter(
        "efficiency", 0.7, "1", "motor's torque that is left behind the gear, both ways", "assumed", least=0.0
    ),
    Parameter(
        "pole_pairs",
        50.0,
        "1",
        "turns of the field for one of the rotor",
        "assumed, 200 full steps",
        least=0.0,
    ),
    Parameter(
        "fading_speed",
        1_500.0 * math.tau / 200.0,
        "rad/s",
        "rotor's speed at which no torque is left, which falls straight to there",
        "assumed, 1500 full steps/s",
        least=0.0,
    ),
    Parameter(
        "damping_time",
        0.01,
        "s",
        "time in which a free rotor loses its speed",
        "assumed, damping of some 2 % at the swing of a step",
        least=0.0,
    ),
    Parameter(
        "driver_damping_time",
        0.0025,
        "s",
        "time in which a rotor loses its swing by its driver, which has current",
        "assumed, 8 % more: a digital driver damps its motor; with 2 % alone the arm would lose its steps at"
        " a quarter of the rate at which its own GUI drives it to the switches without a ramp",
        least=0.0,
    ),
    Parameter(
        "friction",
        0.1,
        "1",
        "dry friction of gear and bearing, part of the motor's torque at rest behind the gear",
        "assumed; a third of what the efficiency takes",
        least=0.0,
    ),
    Parameter(
        "joint_presliding",
        5e-5,
        "rad",
        "way over which dry friction builds up",
        "assumed, a sixth of a step",
        least=0.0,
    ),
    Parameter("stop_stiffness", 5_000.0, "N.m/rad", "stops' stiffness", "assumed"),
    Parameter("stop_damping", 0.5, "s/rad", "stops' damping, part of their torque per speed", "assumed"),
)

SETS: Final[Mapping[str, Mapping[str, float]]] = {
    "bare": {},
    "loaded": {"payload": 1.0},
    "free": {"damping_time": 1e9, "driver_damping_time": 1e9, "friction": 0.0},
}
"""Named arms: without a load, with 1 kg, and without any friction, for tests of its energy."""

ROBOT_FILE: Final[Mapping[str, tuple[str, float]]] = {
    f"axes.{axis}.ratio": (f"gear_{axis}", 1.0) for axis in AXES
}
STOPS: Final[Mapping[str, tuple[str, str]]] = {
    axis: (f"stop_low_{axis}", f"stop_high_{axis}") for axis in AXES
}

PLANT: Final = Plant("ar2", "fmu.ar2", PARAMETERS, SETS, ROBOT_FILE, stops=STOPS)
