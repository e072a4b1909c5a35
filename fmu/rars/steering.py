"""Davis steering: rack, both wheel angles and the rack's dynamics, [R] 2.4, 3.5 and 4.2."""

import sympy as sp

from fmu.export.functions import clamped, reciprocal, size
from fmu.export.model import Event, Expression
from fmu.parts.motor import Shaft
from fmu.parts.symbols import HALF
from fmu.rars.symbols import P


class Steering:
    """The rack on its motor; positive to the left. Numbers in brackets are equations of [R]."""

    def __init__(self, motor: Shaft) -> None:
        self.motor = motor
        self.ratio = P["pinion_diameter"] / (2 * motor.gear)  # m of rack for 1 rad of motor (4.8)
        self.rack = self.ratio * motor.angle
        self.speed = self.ratio * motor.speed
        h = P["davis_h"]
        self.b = h * P["kingpin_distance"] / (2 * P["wheelbase"])  # (2.12)
        self.across = self.rack * h
        self.along = h**2 + self.b**2
        # (3.96): how far the right and the left wheel turn with the rack, rad/m.
        self.rate_right, self.bend_right = self._kingpin(-self.b - self.rack)
        self.rate_left, self.bend_left = self._kingpin(self.b - self.rack)
        self.pressed = self.rack - clamped(self.rack, P["rack_travel"])

    def direction(self, side: int) -> tuple[Expression, Expression]:
        """Return sine and cosine, times one length, of the left (+1) or right (-1) wheel's angle (4.6)."""
        return self.across, self.along - side * self.b * self.rack

    def angle(self, side: int) -> Expression:
        """Return the left (+1) or right (-1) wheel's angle in rad, positive to the left."""
        across, along = self.direction(side)
        return sp.atan(across / along)

    def inner_angle(self) -> Expression:
        """Return the inner wheel's angle, whichever it is: (4.6) with x = sign(theta) f(|theta|)."""
        return sp.atan(self.across / (self.along - self.b * sp.Abs(self.rack)))

    def events(self) -> tuple[Event, ...]:
        """Return where the rack meets its stops."""
        travel = P["rack_travel"]
        return (
            Event("past_rack_left", "m", "rack past its left stop", self.rack - travel),
            Event("past_rack_right", "m", "rack past its right stop", -self.rack - travel),
        )

    def _kingpin(self, arm: Expression) -> tuple[Expression, Expression]:
        """Return f and f f' of one wheel; `arm` is b - x, for the right wheel with its sign turned round."""
        h = P["davis_h"]
        rate = h * reciprocal(h**2 + arm**2)
        return rate, 2 * arm * rate**3 / h

    def tyre_level(self) -> Expression:
        """Return the tyres' resistance at the motor: T_s f(x), of which the printed T_s / h is the middle."""
        return self.ratio * P["tyre_torque"] * (self.rate_right + self.rate_left)

    def acceleration(self) -> Expression:
        """Return the motor's acceleration by (3.97) and (3.98), both corrected."""
        motor = self.motor
        # (3.97) corrected: every term of the bracket is an inertia about the kingpin.
        # (3.98) corrected: factor 1, because the part -dL/dx had been dropped, and f' means df/dx.
        convection = self._wheel_inertia() * (self.bend_right + self.bend_left)
        damping = P["rack_stop_damping"] * self.speed
        stop = P["rack_stop_stiffness"] * (self.pressed + damping * size(self.pressed))
        # The tyres' resistance at the kingpins uses the motor's bristle: both stop and turn round together.
        dry = (motor.coulomb + self.tyre_level()) * motor.friction
        torque = motor.free_torque - dry - self.ratio * (convection * self.speed**2 + stop)
        return torque / (motor.inertia + self.ratio**2 * self._mass())

    def energy(self) -> Expression:
        """Return the energy of rack, stops and tyres in J; the motor's own is the shaft's."""
        pressed = P["rack_stop_stiffness"] * self.pressed**2
        bristle = self.tyre_level() * P["presliding"] * self.motor.friction**2
        return HALF * (self._mass() * self.speed**2 + pressed + bristle)

    def _wheel_inertia(self) -> Expression:
        """J of (3.97) in kg m2."""
        arm, offset = P["link_centre"], P["kingpin_offset"]
        return P["link_mass"] * arm**2 + P["link_inertia"] + offset**2 * P["front_wheel_mass"]

    def _mass(self) -> Expression:
        return P["tie_rod_mass"] + self._wheel_inertia() * (self.rate_right**2 + self.rate_left**2)
