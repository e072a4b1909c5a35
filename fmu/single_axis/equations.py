"""One axis: motor, gear with backlash, load with friction, weight and stops; README.md has them, too."""

from typing import Final

import sympy as sp

from fmu.export.functions import passed, positive_part
from fmu.export.model import Event, Expression, Input, Model, Output, StateVariable
from fmu.parts.battery import terminal_voltage
from fmu.parts.motor import Shaft, bristle
from fmu.parts.stop import push
from fmu.parts.symbols import HALF, inner, symbol, symbols
from fmu.single_axis.parameters import PARAMETERS

P: Final = symbols(PARAMETERS)


class GearLoad:
    """Load on the gear; angles and speeds are those behind it."""

    def __init__(self, motor: Shaft) -> None:
        self.motor = motor
        self.angle, self.speed, self.friction = (
            symbol(f"load_{what}") for what in ("angle", "speed", "friction")
        )
        self.twist = motor.angle / motor.gear - self.angle
        self.twisting = motor.speed / motor.gear - self.speed
        self.ahead = positive_part(self.twist - P["backlash"] / 2)
        self.behind = positive_part(-self.twist - P["backlash"] / 2)
        self.over = positive_part(self.angle - P["stop_high"])
        self.under = positive_part(P["stop_low"] - self.angle)

    def gear_torque(self) -> Expression:
        """Return what the gear gives to the load: nothing while the teeth cross the backlash."""
        stiffness, damping = P["flank_stiffness"], P["flank_damping"]
        # Two flanks, each a stop that only pushes: between them the load is free.
        ahead = push(self.ahead, self.twisting, stiffness, damping)
        return ahead - push(self.behind, -self.twisting, stiffness, damping)

    def acceleration(self) -> Expression:
        """Return the load's acceleration in rad/s2."""
        stiffness, damping = P["stop_stiffness"], P["stop_damping"]
        stops = push(self.under, -self.speed, stiffness, damping) - push(
            self.over, self.speed, stiffness, damping
        )
        rubbing = P["load_coulomb"] * self.friction + P["load_viscous"] * self.speed
        weight = P["unbalance"] * sp.sin(self.angle)
        torque = self.gear_torque() + symbol("load_torque") + stops - rubbing - weight
        return torque / P["load_inertia"]

    def switches(self) -> tuple[Output, ...]:
        """Return the switches: 1 where one is closed, else 0."""
        low, high = P["limit_low"] - self.angle, self.angle - P["limit_high"]
        # A cam between two angles: closed only between its edges.
        cam = passed(self.angle - P["home_low"]) * passed(P["home_high"] - self.angle)
        return (
            Output("negative_limit_axis", "1", "negative limit switch, 1 closed", passed(low), switch=True),
            Output("positive_limit_axis", "1", "positive limit switch, 1 closed", passed(high), switch=True),
            Output("home_axis", "1", "home switch, 1 closed", cam, switch=True),
        )

    def events(self) -> tuple[Event, ...]:
        """Return where something is met: flanks, stops, the edges of the switches; ways in rad."""
        edges = ("stop_low", "stop_high", "limit_low", "limit_high", "home_low", "home_high")
        half = P["backlash"] / 2
        return (
            Event("past_flank_ahead", "rad", "gear's twist past its flank ahead", self.twist - half),
            Event("past_flank_behind", "rad", "gear's twist past its flank behind", -self.twist - half),
            *(
                Event(f"past_{edge}", "rad", f"load's angle past {edge}", self.angle - P[edge])
                for edge in edges
            ),
        )

    def states(self) -> tuple[StateVariable, ...]:
        """Return the load's states; it starts where the motor stands, and as fast."""
        motor = self.motor
        return (
            StateVariable("load_angle", "rad", motor.angle / motor.gear, self.speed),
            StateVariable("load_speed", "rad/s", motor.speed / motor.gear, self.acceleration()),
            StateVariable(
                "load_friction",
                "1",
                sp.S.Zero,
                bristle(self.speed, self.friction, P["load_presliding"]),
            ),
        )

    def energy(self) -> Expression:
        """Return the energy of load, flanks, stops and weight in J."""
        kinetic = P["load_inertia"] * self.speed**2
        flanks = P["flank_stiffness"] * (self.ahead**2 + self.behind**2)
        stops = P["stop_stiffness"] * (self.over**2 + self.under**2)
        dry = P["load_coulomb"] * P["load_presliding"] * self.friction**2
        return HALF * (kinetic + flanks + stops + dry) + P["unbalance"] * (1 - sp.cos(self.angle))


class Brake:
    """A holding brake on the motor's shaft: a bristle that grips while the brake is closed."""

    def __init__(self, motor: Shaft) -> None:
        self.closed, self.grip = symbol("brake_axis"), symbol("brake_grip")
        self.torque = P["brake_torque"] * self.grip
        # Closed it is a dry friction; open, the grip fades with the opening time.
        gripping = self.closed * bristle(motor.speed, self.grip, P["brake_presliding"])
        self.state = StateVariable(
            "brake_grip", "1", sp.S.Zero, gripping - (1 - self.closed) * self.grip / P["brake_opening"]
        )
        self.energy = HALF * P["brake_torque"] * P["brake_presliding"] * self.grip**2


def model() -> Model:
    """Return the equations of the bench axis with all tables."""
    motor = Shaft("axis", P)
    load, brake = GearLoad(motor), Brake(motor)
    acceleration = (motor.torque - brake.torque - load.gear_torque() / motor.gear) / motor.inertia
    return Model(
        name="single_axis",
        description="One DC motor with gear, backlash and a load between stops",
        parameters=PARAMETERS,
        inputs=(
            Input("voltage_axis", "V", "motor voltage", 24.0),
            Input("load_torque", "N.m", "torque from outside on the load, positive forwards", 1.0),
            Input("brake_axis", "1", "holding brake, 1 closed, 0 open", 1.0, switch=True),
        ),
        states=(*motor.states(acceleration), *load.states(), brake.state),
        outputs=(
            *motor.outputs(),
            Output("load_angle", "rad", "load's angle", load.angle, 1.0),
            Output("load_speed", "rad/s", "load's speed", load.speed, 1.0),
            Output(
                "battery_voltage",
                "V",
                "battery's terminal voltage",
                terminal_voltage((motor,), P),
                24.0,
                least=0.0,
            ),
            *load.switches(),
            motor.dry_friction(),
            inner("gear_torque", "N.m", "torque of the gear on the load", load.gear_torque()),
            inner(
                "energy",
                "J",
                "energy stored in the whole axis",
                motor.energy() + load.energy() + brake.energy,
                10.0,
            ),
        ),
        inner_step=50e-6,
        events=load.events(),
    )
