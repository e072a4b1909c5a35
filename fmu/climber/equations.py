"""The climbing robot as one model: contacts, chassis, motors, weight; in mathematical writing: README.md.

[C] is Qualls, Canfield, Shibakov, JAMRIS 10(3), 2016.
"""

from typing import Final

import sympy as sp

from fmu.climber.chassis import Chassis, Motion
from fmu.climber.contact import Contact
from fmu.climber.parameters import AXES, PARAMETERS
from fmu.climber.vectors import Vector, dot, plus
from fmu.export.model import Expression, Input, Model, Output, State
from fmu.parts.battery import terminal_voltage
from fmu.parts.motor import Shaft
from fmu.parts.symbols import HALF, inner, symbol, symbols

P: Final = dict(symbols(PARAMETERS))
CONTACTS: Final = ("tube", "arc", "height", "psi")
UNITS: Final = {"tube": "rad", "arc": "m", "height": "m", "psi": "rad"}


class Climber:
    """The robot; vectors stand in the frame of the left contact: out of the tank, round it, along it."""

    def __init__(self, left: Shaft, right: Shaft) -> None:
        self.shafts = (left, right)
        self.spins = (left.speed / left.gear, right.speed / right.gear)
        radii = P["crown_radius"], P["wheel_radius"], P["tank_radius"]
        turn = (symbol("arc_right") - symbol("arc_left")) / P["tank_radius"]
        rise = symbol("height_right") - symbol("height_left")
        # r_c (cos(turn) - 1) without the difference of two large numbers
        inwards = -2 * P["tank_radius"] * sp.sin(turn / 2) ** 2
        nothing: Vector = (sp.S.Zero, sp.S.Zero, sp.S.Zero)
        self.left = Contact(symbol("tube_left"), symbol("psi_left"), nothing, sp.S.Zero, radii)
        place: Vector = (inwards, P["tank_radius"] * sp.sin(turn), rise)
        self.right = Contact(symbol("tube_right"), symbol("psi_right"), place, turn, radii)
        pitch = symbol("pitch")
        ahead = plus((sp.cos(pitch), self.left.ahead), (sp.sin(pitch), self.left.upright()))
        self.chassis = Chassis(self.left, self.right, ahead, P["half_track"])
        self.unit = (
            self.chassis.motion(sp.S.One, sp.S.Zero, P["caster_distance"]),
            self.chassis.motion(sp.S.Zero, sp.S.One, P["caster_distance"]),
        )

    def together(self) -> Motion:
        """Return the motion at the wheels' present speeds."""
        first, second = self.unit
        a, b = self.spins
        return Motion(
            plus((a, first.turning), (b, second.turning)),
            a * first.joint + b * second.joint,
            plus((a, first.slip), (b, second.slip)),
        )

    def weight(self) -> tuple[Expression, Expression]:
        """Return the torque of the weight on each wheel, by virtual work."""
        down = self._down()
        torques = (P["mass"] * dot(down, self.chassis.velocity(unit, P["mass_behind"])) for unit in self.unit)
        left, right = torques
        return left, right

    def accelerations(self) -> tuple[Expression, Expression]:
        """Return the motors' accelerations; inertia is that of the robot on a plane (ASSUME)."""
        same, other = self._inertia()
        gear = P["gear_wheel"]
        torques = [
            shaft.gear * shaft.torque - P["gear_friction"] * shaft.friction + weight
            for shaft, weight in zip(self.shafts, self.weight(), strict=True)
        ]
        determinant = same**2 - other**2
        first = gear * (same * torques[0] - other * torques[1]) / determinant
        second = gear * (same * torques[1] - other * torques[0]) / determinant
        return first, second

    def states(self) -> tuple[State, ...]:
        """Return both contacts, pitch and joint; it starts upright on its wheels, looking up the tank."""
        motion = self.together()
        left_wheel = plus((1, motion.turning), (self.spins[0], self.left.axle))
        right_half = plus((1, motion.turning), (motion.joint, self.chassis.longitudinal))
        right_wheel = plus((1, right_half), (self.spins[1], self.right.axle))
        half = P["tank_radius"] * sp.atan(P["half_track"] / (P["tank_radius"] + P["wheel_radius"]))
        rows: list[State] = []
        # Looking along the axis (psi = pi), the left wheel stands at the smaller arc.
        for side, contact, turning, arc in (
            ("left", self.left, left_wheel, -half),
            ("right", self.right, right_wheel, half),
        ):
            rates = contact.rates(turning)
            starts = {"tube": sp.S.Zero, "arc": arc, "height": sp.S.Zero, "psi": P["start_psi"]}
            rows += [State(f"{name}_{side}", UNITS[name], starts[name], rates[name]) for name in CONTACTS]
            if side == "left":
                rows.append(State("pitch", "rad", sp.S.Zero, self.spins[0] - rates["wheel"]))
        rows.append(State("joint", "rad", 2 * half / P["tank_radius"], motion.joint))
        return tuple(rows)

    def energy(self) -> Expression:
        """Return the energy of robot and wheels in J; the rotors' own is the shafts'."""
        same, other = self._inertia()
        rotor = P["rotor_inertia_wheel"] * P["gear_wheel"] ** 2
        left, right = self.spins
        kinetic = (same - rotor) * (left**2 + right**2) + 2 * other * left * right
        dry = P["gear_friction"] * P["presliding"] / P["gear_wheel"]
        dry *= sum(shaft.friction**2 for shaft in self.shafts)
        place = self.chassis.behind(P["mass_behind"])
        turn = symbol("arc_left") / P["tank_radius"]
        out, around, along = place
        tank = P["tank_radius"]
        # The left contact's frame turns with it: lift the tank's own radius out of the large numbers.
        x = (tank + out) * sp.cos(turn) - tank - around * sp.sin(turn)
        high = sp.cos(P["axis_tilt"]) * x + sp.sin(P["axis_tilt"]) * (along + symbol("height_left"))
        return HALF * (kinetic + dry) + P["mass"] * P["gravity"] * high

    def _down(self) -> Vector:
        turn = symbol("arc_left") / P["tank_radius"]
        across = P["gravity"] * sp.cos(P["axis_tilt"])
        return (-across * sp.cos(turn), across * sp.sin(turn), -P["gravity"] * sp.sin(P["axis_tilt"]))

    def _inertia(self) -> tuple[Expression, Expression]:
        """Inertia of one wheel with its motor, and between both, of the robot on a plane."""
        radius, track = P["wheel_radius"], P["half_track"]
        forwards = P["mass"] * radius**2 / 4
        turning = P["yaw_inertia"] * radius**2 / (4 * track**2)
        rotor = P["rotor_inertia_wheel"] * P["gear_wheel"] ** 2
        return forwards + turning + P["wheel_inertia"] + rotor, forwards - turning


def model() -> Model:
    """Return the equations of the climbing robot with all tables."""
    wheel = {name.removesuffix("wheel"): value for name, value in P.items() if name.endswith("_wheel")}
    left, right = (Shaft(axis, P | {name + axis: value for name, value in wheel.items()}) for axis in AXES)
    robot = Climber(left, right)
    first, second = robot.accelerations()
    height = (symbol("height_left") + symbol("height_right")) * HALF
    arc = (symbol("arc_left") + symbol("arc_right")) * HALF
    speed = P["wheel_radius"] * sum(robot.spins) * HALF
    energy = left.energy() + right.energy() + robot.energy()
    contacts = [
        Output(f"{name}_{side}", UNITS[name], f"{name} of the {side} contact", symbol(f"{name}_{side}"), 1.0)
        for side in AXES
        for name in CONTACTS
    ]
    return Model(
        name="climber",
        description="Climbing robot: two magnetic wheels, a joint and a caster on a cylinder",
        parameters=PARAMETERS,
        inputs=tuple(Input(f"voltage_{axis}", "V", f"motor voltage, {axis}", 24.0) for axis in AXES),
        states=(*left.states(first), *right.states(second), *robot.states()),
        outputs=(
            *left.outputs(),
            *right.outputs(),
            Output("arc", "m", "way round the tank, middle of both contacts", arc, 1.0),
            Output("height", "m", "way along the tank's axis, middle of both contacts", height, 1.0),
            Output(
                "heading",
                "rad",
                "direction from the arc towards the axis",
                symbol("psi_left") - sp.pi / 2,
                1.0,
            ),
            Output("speed", "m/s", "speed forwards as the wheels roll", speed, 0.1),
            *contacts,
            Output("pitch", "rad", "left half about its axle, nose up positive", symbol("pitch"), 0.1),
            Output("joint", "rad", "right half against the left", symbol("joint"), 0.1),
            Output(
                "battery_voltage",
                "V",
                "battery's terminal voltage",
                terminal_voltage((left, right), P),
                24.0,
                least=0.0,
            ),
            left.dry_friction(),
            right.dry_friction(),
            inner("energy", "J", "energy stored in the whole robot", energy, 10.0),
        ),
        inner_step=50e-6,
    )
