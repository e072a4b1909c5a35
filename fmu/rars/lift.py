"""Scissor lift on its screw, [R] 2.5: height, lifting force, friction in the thread, end stops."""

import sympy as sp

from fmu.export.functions import clamped, positive_part, reciprocal, size
from fmu.export.model import Event, Expression
from fmu.parts.motor import Shaft
from fmu.parts.symbols import HALF
from fmu.rars.symbols import P


class Lift:
    """N stages of links of length l_s, one end drawn along the base by a screw; angle 0 is collapsed."""

    def __init__(self, motor: Shaft) -> None:
        self.motor = motor
        self.ratio = P["screw_pitch"] / (2 * sp.pi * motor.gear)  # m of nut for 1 rad of motor
        link, stages = P["lift_link_length"], P["lift_stages"]
        self.travel = self.ratio * motor.angle
        self.speed = self.ratio * motor.speed
        self.base = link * sp.cos(P["lift_collapsed_angle"]) - self.travel  # x of (2.16)
        self.rise = sp.sqrt(link**2 - self.base**2)  # y of (2.16)
        self.height = stages * (self.rise - link * sp.sin(P["lift_collapsed_angle"]))
        self.per_rise = reciprocal(self.rise)
        self.gain = stages * self.base * self.per_rise  # dh/dx = N / tan(theta)
        self.mass = P["lift_mass"] + P["lift_payload"]
        self.load = self.mass * P["gravity"] * self.gain  # F = W N / tan(theta) (2.17)
        middle = HALF * link * (sp.cos(P["lift_collapsed_angle"]) - sp.cos(P["lift_extended_angle"]))
        from_middle, free = self.travel - middle, middle + P["lift_clearance"]
        # One expression for both stops: 0 between them, with the sign of the one that is met.
        self.pressed = from_middle - clamped(from_middle, free)
        self._past = (-from_middle - free, from_middle - free)
        self._thread = P["screw_friction"] / sp.cos(P["thread_angle"])  # mu sec(alpha)

    def events(self) -> tuple[Event, ...]:
        """Return where the nut meets its stops."""
        ends = zip(("collapsed", "extended"), self._past, strict=True)
        return tuple(Event(f"past_lift_{end}", "m", f"nut past its stop, {end}", way) for end, way in ends)

    def friction_start(self) -> Expression:
        """Return the bristle's state that holds the load at rest; -1 where the screw does not lock itself.

        The root of coulomb s + screw_torque(s) / gear = 0, in the form that bears coulomb = 0.
        """
        diameter, pitch, dry = P["screw_diameter"], P["screw_pitch"], self.motor.coulomb
        force = self.load * diameter / (2 * self.motor.gear)
        half = HALF * sp.pi * diameter * (dry + force * self._thread)
        root = sp.sqrt(half**2 + dry * self._thread * pitch * force * pitch)
        balance = -force * pitch / (half + root)
        return positive_part(balance + 1) - 1

    def screw_torque(self) -> Expression:
        """Return the torque on the screw: (2.18) at friction +1, lowering at -1, sticking between."""
        diameter, pitch = P["screw_diameter"], P["screw_pitch"]
        thread = self._thread * self.motor.friction
        # tan(lead angle + friction angle), without a tangent;
        # the sign of the bristle turns raising into lowering.
        slope = (pitch + sp.pi * thread * diameter) / (sp.pi * diameter - thread * pitch)
        return self.load * diameter / 2 * slope

    def acceleration(self) -> Expression:
        """Return the motor's acceleration; friction comes from the static load (assumed)."""
        motor = self.motor
        bend = -P["lift_stages"] * P["lift_link_length"] ** 2 * self.per_rise**3  # d2h/dx2
        # The gain changes with the travel: the load is accelerated also at a constant speed of the screw.
        convection = self.mass * self.gain * bend * self.speed**2
        damping = P["lift_stop_damping"] * self.speed
        stop = P["lift_stop_stiffness"] * (self.pressed + damping * size(self.pressed))
        dry = motor.coulomb * motor.friction
        torque = motor.free_torque - dry - self.screw_torque() / motor.gear - self.ratio * (convection + stop)
        return torque / (motor.inertia + self.ratio**2 * self.mass * self.gain**2)

    def energy(self) -> Expression:
        """Return the energy of load, stops and thread (to first order) in J."""
        kinetic = HALF * self.mass * (self.gain * self.speed) ** 2
        weight = self.mass * P["gravity"] * self.height
        pressed = HALF * P["lift_stop_stiffness"] * self.pressed**2
        level = self.load * self._thread * P["screw_diameter"] / (2 * self.motor.gear)
        bristle = HALF * level * P["presliding"] * self.motor.friction**2
        return kinetic + weight + pressed + bristle
