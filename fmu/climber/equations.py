"""The climbing robot as one model: contacts, chassis, motors, weight, magnets; README.md has them, too.

[C] is Qualls, Canfield, Shibakov, JAMRIS 10(3), 2016.
"""

from functools import cache
from typing import Final

import sympy as sp

from fmu.climber.adhesion import Hold, Surroundings
from fmu.climber.chassis import Chassis, JointSide, Sizes
from fmu.climber.contact import Contact, Torus
from fmu.climber.parameters import AXES, PARAMETERS
from fmu.climber.start import Given, Start
from fmu.climber.surfaces import Surface, torus
from fmu.climber.vectors import Vector, dot, product
from fmu.export.functions import larger, named, passed, positive_part
from fmu.export.model import Event, Expression, Input, Model, Output, StateVariable
from fmu.parts.battery import terminal_voltage
from fmu.parts.motor import Shaft
from fmu.parts.symbols import HALF, inner, symbol, symbols

P: Final = dict(symbols(PARAMETERS))
WHEELS: Final = ("left", "right", "caster")
CONTACTS: Final = ("tube", "arc", "height", "psi")
UNITS: Final = {"tube": "rad", "arc": "m", "height": "m", "psi": "rad"}
TANK: Final = torus(P["tank_radius"], P["ring_radius"])
SIZES: Final = Sizes(
    P["half_track"], P["caster_distance"], P["wheel_radius"] - P["caster_radius"], P["caster_offset"]
)
SIDE: Final = JointSide.of(P["joint_side"])
_WHEEL: Final = Torus(P["crown_radius"], P["wheel_radius"])
TORI: Final = (_WHEEL, _WHEEL, Torus(P["caster_crown"], P["caster_radius"]))


class Climber:
    """The robot on a surface; vectors in the world's frame: out of the tank, round it, along it."""

    def __init__(self, left: Shaft, right: Shaft, surface: Surface = TANK) -> None:
        self.surface = surface
        self.shafts = (left, right)
        self.spins = (named(left.speed / left.gear), named(right.speed / right.gear))
        left_contact, right_contact, caster_contact = (
            Contact(
                symbol(f"tube_{side}"),
                symbol(f"psi_{side}"),
                surface(symbol(f"arc_{side}"), symbol(f"height_{side}")),
                wheel,
            )
            for side, wheel in zip(WHEELS, TORI, strict=True)
        )
        self.contacts = (left_contact, right_contact, caster_contact)
        self.chassis = Chassis(self.contacts, symbol("pitch"), SIZES, SIDE)
        self.joint = symbol("joint")
        self._rolling = self.chassis.rolling(*self.spins)
        self.over, self.under = self.joint - P["joint_stop"], -P["joint_stop"] - self.joint
        # The tank's axis is tilted: at pi/2 it is upright, and the weight is along it.
        across = P["mass"] * P["gravity"] * sp.cos(P["axis_tilt"])
        self._weight: Vector = (-across, sp.S.Zero, -P["mass"] * P["gravity"] * sp.sin(P["axis_tilt"]))
        self._mass = self.chassis.at(-P["mass_behind"], P["mass_height"] - P["wheel_radius"])
        self.forces = self.chassis.forces(self._weight, self._mass, self._joint_torque())
        around = Surroundings(P["magnet_reach"], P["wall_friction"], P["slip_damping"])
        magnets = (
            *(P["magnet_wheel"] * (1 - symbol(f"grip_lost_{axis}")) for axis in AXES),
            P["magnet_caster"],
        )
        self.holds = [
            Hold(side, contact, force, magnet, around)
            for side, contact, force, magnet in zip(WHEELS, self.contacts, self.forces, magnets, strict=True)
        ]
        left_gap, right_gap, caster_gap = (hold.gap for hold in self.holds)
        self.past_hold = larger(larger(left_gap, right_gap), caster_gap) - P["magnet_reach"]
        # One magnet beyond its reach is enough: the rates of
        # the contacts are 0 from then on, and the robot falls.
        self.fallen = named(passed(self.past_hold))

    def _joint_torque(self) -> Expression:
        """Return the torque on the right half about the joint: spring, damping, stops."""
        spring = P["joint_spring"] * (self.joint - P["joint_rest"])
        stops = P["stop_stiffness"] * (positive_part(self.under) - positive_part(self.over))
        return named(stops - spring - P["joint_damping"] * self._rolling.joint)

    def accelerations(self) -> tuple[Expression, Expression]:
        """Return the motors' accelerations; inertia is that of the robot on a plane (assumed).

        The surface pushes at the rim; where magnets have let go, a wheel turns alone.
        """
        same, other = self._inertia()
        # Off the wall a wheel accelerates itself only.
        alone = P["wheel_inertia"] + self._rotor()
        gear = P["gear_wheel"]
        on_wall = 1 - self.fallen
        torques = [
            named(
                shaft.gear * shaft.torque
                - P["gear_friction"] * shaft.friction
                - on_wall * contact.width * dot(force, contact.ahead)
            )
            for shaft, contact, force in zip(self.shafts, self.contacts, self.forces, strict=False)
        ]
        mean = named((torques[0] + torques[1]) * HALF)
        half = named((torques[0] - torques[1]) * HALF * (1 - P["coupled"]))
        # The 2 x 2 inertia of both wheels has the same diagonal: sum and difference are its own directions.
        common = gear * mean * (on_wall / (same + other) + self.fallen / alone)
        apart = gear * half * (on_wall / (same - other) + self.fallen / alone)
        return common + apart, common - apart

    def states(self) -> tuple[StateVariable, ...]:
        """Return contacts, pitch, joint, swivel, gaps and fall; contacts start where `Start` finds them."""
        slides = [hold.slide for hold in self.holds]
        motion = self._rolling.plus(self.chassis.sliding(*slides))
        turnings = self.chassis.turnings(motion, self.spins)
        given = Given(*(P[f"start_{name}"] for name in ("arc", "height", "heading", "swivel", "joint")))
        starts = Start(self.surface, given, SIZES, SIDE, TORI).rows
        on_wall = 1 - self.fallen
        self.yaw_rate = sp.S.Zero
        rows: list[StateVariable] = []
        pitching: list[Expression] = []
        for side, contact, turning, slide in zip(WHEELS, self.contacts, turnings, slides, strict=True):
            rates = contact.rates(turning, slide)
            rows += [
                StateVariable(name, UNITS[name.partition("_")[0]], starts[name], on_wall * rates[what])
                for what, name in ((what, f"{what}_{side}") for what in CONTACTS)
            ]
            if side != "caster":
                # The wheel's spin against its half, less what it rolls on the surface: the half's pitch.
                pitching.append(on_wall * (self.spins[len(pitching)] - rates["wheel"]))
                self.yaw_rate += HALF * on_wall * rates["psi"]
        return (
            *rows,
            StateVariable("pitch", "rad", starts["pitch"], SIDE.fixed(*pitching)),
            StateVariable("joint", "rad", starts["joint"], on_wall * motion.joint),
            StateVariable("swivel", "rad", P["start_swivel"], on_wall * motion.swivel),
            *(hold.state() for hold in self.holds),
            StateVariable("fall_speed", "m/s", sp.S.Zero, self.fallen * P["gravity"]),
            StateVariable("fall", "m", sp.S.Zero, symbol("fall_speed")),
        )

    def events(self) -> tuple[Event, ...]:
        """Return where a magnet is lost, and where the joint meets its stops."""
        return (
            Event("past_hold", "m", "largest gap past the magnets' reach", self.past_hold),
            Event("past_stop_high", "rad", "joint past its upper stop", self.over),
            Event("past_stop_low", "rad", "joint past its lower stop", self.under),
        )

    def energy(self) -> Expression:
        """Return the energy of robot, wheels and joint in J; the rotors' own is the shafts'."""
        same, other = self._inertia()
        left, right = self.spins
        on_wall = 1 - self.fallen
        alone = P["wheel_inertia"] * (left**2 + right**2)
        kinetic = (same - self._rotor()) * (left**2 + right**2) + 2 * other * left * right
        kinetic = on_wall * kinetic + self.fallen * alone + P["mass"] * symbol("fall_speed") ** 2
        dry = P["gear_friction"] * P["presliding"] / P["gear_wheel"]
        dry *= sum(shaft.friction**2 for shaft in self.shafts)
        spring = P["joint_spring"] * (self.joint - P["joint_rest"]) ** 2
        stops = P["stop_stiffness"] * (positive_part(self.over) ** 2 + positive_part(self.under) ** 2)
        high = dot(self._weight, self._mass) + P["mass"] * P["gravity"] * symbol("fall")
        return HALF * (kinetic + dry + spring + stops) - high

    @staticmethod
    def _rotor() -> Expression:
        return P["rotor_inertia_wheel"] * P["gear_wheel"] ** 2

    def _inertia(self) -> tuple[Expression, Expression]:
        """Inertia of one wheel with its motor, and between both, of the robot on a plane."""
        radius, track = P["wheel_radius"], P["half_track"]
        forwards = P["mass"] * radius**2 / 4
        turning = P["yaw_inertia"] * radius**2 / (4 * track**2)
        return forwards + turning + P["wheel_inertia"] + self._rotor(), forwards - turning


def in_space(arc: Expression, height: Expression, heading: Expression) -> tuple[Output, ...]:
    """Return where cameras would see the robot: its place on the surface, and its axes there.

    Its x is ahead, y to the left, z off the surface. At the surface's origin, with a heading of 0, they are
    the world's y, z and x.
    """
    out, across, along = TANK(arc, height).point
    out -= symbol("fall") * sp.cos(P["axis_tilt"])
    along -= symbol("fall") * sp.sin(P["axis_tilt"])
    position = zip("xyz", (out, across, along), strict=True)
    # Half angles, as quaternions have them.
    half_round, half_up, half_turn = (
        angle * HALF
        for angle in (arc / P["tank_radius"], -height / (P["ring_radius"] + P["tank_radius"]), heading)
    )
    turns = (
        (sp.S.Zero, sp.sin(half_up), sp.S.Zero, sp.cos(half_up)),
        (sp.S.Zero, sp.S.Zero, sp.sin(half_round), sp.cos(half_round)),
        (HALF, HALF, HALF, HALF),
        (sp.S.Zero, sp.S.Zero, sp.sin(half_turn), sp.cos(half_turn)),
    )
    attitude = zip("xyzw", product(product(product(*turns[:2]), turns[2]), turns[3]), strict=True)
    return (
        *(Output(name, "m", f"robot in space, {name}", each, 1.0) for name, each in position),
        *(
            Output(f"q{name}", "1", f"its attitude, a quaternion's {name}", each, 1.0)
            for name, each in attitude
        ),
    )


@cache
def model(surface: Surface = TANK) -> Model:
    """Return the equations of the climbing robot with all tables.

    Made once in a process: SymPy's own memory compares what is equal but not the same to its last leaf, and
    would not end.
    """
    wheel = {name.removesuffix("wheel"): value for name, value in P.items() if name.endswith("_wheel")}
    left, right = (Shaft(axis, P | {name + axis: value for name, value in wheel.items()}) for axis in AXES)
    robot = Climber(left, right, surface)
    first, second = robot.accelerations()
    states = robot.states()
    height = (symbol("height_left") + symbol("height_right")) * HALF
    arc = (symbol("arc_left") + symbol("arc_right")) * HALF
    heading = (symbol("psi_left") + symbol("psi_right")) * HALF - sp.pi / 2
    speed = P["wheel_radius"] * sum(robot.spins) * HALF
    energy = left.energy() + right.energy() + robot.energy()
    contacts = [
        Output(f"{name}_{side}", UNITS[name], f"{name} of the {side} contact", symbol(f"{name}_{side}"), 1.0)
        for side in WHEELS
        for name in CONTACTS
    ]
    return Model(
        name="climber",
        description="Climbing robot: two magnetic wheels, a joint and a caster on a tank",
        parameters=PARAMETERS,
        inputs=(
            *(Input(f"voltage_{axis}", "V", f"motor voltage, {axis}", 24.0) for axis in AXES),
            *(
                Input(f"grip_lost_{axis}", "1", f"share of a magnet that is lost, {axis}", 1.0)
                for axis in AXES
            ),
        ),
        states=(*left.states(first), *right.states(second), *states),
        outputs=(
            *left.outputs(),
            *right.outputs(),
            Output("arc", "m", "way round the tank, middle of both contacts", arc, 1.0),
            Output("height", "m", "way along the tank's axis, middle of both contacts", height, 1.0),
            Output("heading", "rad", "direction from the arc towards the axis", heading, 1.0),
            Output("speed", "m/s", "speed forwards as the wheels roll", speed, 0.1),
            *in_space(arc, height, heading),
            Output("yaw_rate", "rad/s", "how fast the heading turns", robot.yaw_rate, 1.0),
            *contacts,
            Output("pitch", "rad", "chassis about its axle, nose up positive", symbol("pitch"), 0.1),
            Output("joint", "rad", "right half against the left", symbol("joint"), 0.1),
            Output(
                "analogue_2_left",
                "V",
                "joint's sensor, at the second analogue input of the left drive",
                P["joint_sensor_rest"] + symbol("joint") / P["joint_sensor"],
                1.0,
            ),
            Output(
                "analogue_1_right",
                "V",
                "switches beside the magnets, at the first analogue input of the right drive",
                5 * (1 - robot.fallen),
                1.0,
                switch=True,
            ),
            Output("swivel", "rad", "caster's angle, 0 trailing, to the left", symbol("swivel"), 1.0),
            Output("fallen", "1", "1: magnets have let go and it falls, else 0", robot.fallen, switch=True),
            Output("fall", "m", "how far it has fallen", symbol("fall"), 1.0),
            Output(
                "battery_voltage",
                "V",
                "battery's terminal voltage",
                terminal_voltage((left, right), P),
                24.0,
                least=0.0,
            ),
            *(row for hold in robot.holds for row in hold.outputs()),
            left.dry_friction(),
            right.dry_friction(),
            inner("energy", "J", "energy stored in the whole robot", energy, 10.0),
        ),
        inner_step=100e-6,
        events=robot.events(),
    )
