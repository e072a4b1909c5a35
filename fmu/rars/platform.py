"""The platform: rear wheels roll without slip, front wheels push the axle sideways, [R] 3.3 and 3.4."""

import sympy as sp

from fmu.export.functions import clamped
from fmu.export.model import Expression, State
from fmu.rars.shaft import HALF, P, Shaft, symbol
from fmu.rars.steering import Steering

LEFT, RIGHT = 1, -1


class Platform:
    """Two coupled equations in v, the speed of the rear axle's middle, and W, the yaw rate to the left."""

    def __init__(self, left: Shaft, right: Shaft, steering: Steering) -> None:
        self.left, self.right, self.steering = left, right, steering
        self.heading = symbol("heading")
        radius, track = P["wheel_radius"], P["rear_track"]
        wheel_left, wheel_right = left.speed / left.gear, right.speed / right.gear
        self.speed = radius * (wheel_left + wheel_right) * HALF
        self.yaw_rate = radius * (wheel_right - wheel_left) / track  # (5.1) corrected: right minus left
        # Wheel and reflected rotor, as a mass at the rim: s of the two equations is their sum.
        self.rim_left = (P["wheel_spin_inertia"] + left.inertia * left.gear**2) / radius**2
        self.rim_right = (P["wheel_spin_inertia"] + right.inertia * right.gear**2) / radius**2
        self.offset_mass = P["platform_mass"] * P["centre_offset"]
        self.total_mass = P["platform_mass"] + 2 * P["wheel_mass"]
        self.axle_inertia = (
            P["yaw_inertia"]
            + 2 * P["wheel_yaw_inertia"]
            + self.offset_mass * P["centre_offset"]
            + 2 * P["wheel_mass"] * (track / 2) ** 2
        )

    def slip_angle(self, side: int) -> Expression:
        """Return a front wheel's slip angle in rad, faded below `slip_speed` (ASSUME)."""
        rolling, sideways, _, _ = self._wheel_motion(side)
        return sp.atan(sideways / sp.sqrt(rolling**2 + P["slip_speed"] ** 2))

    def side_force(self, side: int) -> Expression:
        """Return a front tyre's force in N along its axle: (3.83) corrected, flat beyond 1 rad (ASSUME)."""
        load = P["platform_mass"] * P["gravity"] * P["centre_offset"] / P["wheelbase"] * HALF
        slip = self.slip_angle(side)
        # Odd and piecewise linear: peak at 0.15, 0.66 of it from 1 on.
        fall = sp.Rational(34, 85)
        near = (sp.Rational(20, 3) + fall) * clamped(slip, sp.Rational(3, 20))
        return -load * P["floor_friction"] * (near - fall * clamped(slip, sp.S.One))

    def accelerations(self) -> tuple[Expression, Expression]:
        """Return the wheel motors' accelerations, left and right.

        (m_t + s) v' - m_p a W2 = F_v and (I_O + s l2/4) W' + m_p a v W = F_W: the convective terms that
        [R] 3.3.2 takes as zero do not vanish, because a is not zero.
        """
        radius, half_track = P["wheel_radius"], P["rear_track"] / 2
        pull_left = self.left.gear * self._torque(self.left) / radius
        pull_right = self.right.gear * self._torque(self.right) / radius
        weight = P["gravity"] * sp.sin(P["slope"])  # (3.44) corrected: the mass was missing
        along = (
            pull_left
            + pull_right
            + self.offset_mass * self.yaw_rate**2
            - self.total_mass * weight * sp.cos(self.heading)
        )
        around = (
            half_track * (pull_right - pull_left)
            - self.offset_mass * self.speed * self.yaw_rate
            + self.offset_mass * weight * sp.sin(self.heading)
        )
        for side in (LEFT, RIGHT):
            _, _, lever_along, lever_around = self._wheel_motion(side)
            force = self.side_force(side)
            along += force * lever_along
            around += force * lever_around
        m11, m12, m22 = self._inertia()
        determinant = m11 * m22 - m12**2
        v_dot = m22 / determinant * along - m12 / determinant * around
        w_dot = m11 / determinant * around - m12 / determinant * along
        return (
            self.left.gear / radius * (v_dot - half_track * w_dot),
            self.right.gear / radius * (v_dot + half_track * w_dot),
        )

    def states(self) -> tuple[State, ...]:
        """Return the pose of the rear axle's middle in the world, heading counter-clockwise."""
        return (
            State("x", "m", sp.S.Zero, self.speed * sp.cos(self.heading)),
            State("y", "m", sp.S.Zero, self.speed * sp.sin(self.heading)),
            State("heading", "rad", sp.S.Zero, self.yaw_rate),
        )

    def energy(self) -> Expression:
        """Return the energy of platform and rear wheels in J; the rotors' own is the shafts'."""
        platform = self.total_mass * self.speed**2 + self.axle_inertia * self.yaw_rate**2
        spin = P["wheel_spin_inertia"] * (
            (self.left.speed / self.left.gear) ** 2 + (self.right.speed / self.right.gear) ** 2
        )
        climb = self.total_mass * symbol("x") + self.offset_mass * sp.cos(self.heading)
        return HALF * (platform + spin) + P["gravity"] * sp.sin(P["slope"]) * climb

    def _torque(self, shaft: Shaft) -> Expression:
        return shaft.free_torque - shaft.coulomb * shaft.friction

    def _inertia(self) -> tuple[Expression, Expression, Expression]:
        half_track = P["rear_track"] / 2
        both = self.rim_left + self.rim_right
        return (
            self.total_mass + both,
            (self.rim_right - self.rim_left) * half_track,
            self.axle_inertia + both * half_track**2,
        )

    def _wheel_motion(self, side: int) -> tuple[Expression, Expression, Expression, Expression]:
        """Return a front wheel's speed forward and to its left, and how its side force drives v and W."""
        across, along = self.steering.direction(side)
        length = sp.sqrt(across**2 + along**2)
        sine, cosine = across / length, along / length
        lateral = side * P["kingpin_distance"] / 2
        hub = self.speed - self.yaw_rate * lateral
        swing = self.yaw_rate * P["wheelbase"]
        rolling = hub * cosine + swing * sine
        sideways = swing * cosine - hub * sine
        return rolling, sideways, -sine, P["wheelbase"] * cosine + lateral * sine
