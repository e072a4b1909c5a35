"""The platform on four tyres: two driven rear wheels, two steered front wheels, a slope, [R] 3.3, 3.4."""

import sympy as sp

from fmu.export.functions import clamped, reciprocal, shared
from fmu.export.model import Expression, State
from fmu.parts.motor import Shaft, bristle
from fmu.parts.symbols import HALF, symbol
from fmu.rars.steering import Steering
from fmu.rars.symbols import P
from fmu.rars.tyre import TRACE, Tyre

LEFT, RIGHT = 1, -1
SIDES = {"left": LEFT, "right": RIGHT}


class Front:
    """A steered wheel that rolls freely: where it points, how it moves, what its tyre does."""

    def __init__(
        self, side: str, steering: Steering, motion: tuple[Expression, Expression, Expression]
    ) -> None:
        self.name = f"front_{side}"
        self.spin, self.friction = symbol(f"spin_{self.name}"), symbol(f"rolling_{self.name}")
        self.lateral = SIDES[side] * P["kingpin_distance"] / 2
        across, along = steering.direction(SIDES[side])
        per_length = reciprocal(sp.sqrt(across**2 + along**2))
        self.sine, self.cosine = shared(across * per_length), shared(along * per_length)
        hub, swing = self._kingpin(motion)
        self.tyre = Tyre(
            self.name,
            rim=P["front_radius"] * self.spin,
            back=-hub * self.cosine - swing * self.sine,
            right=hub * self.sine - swing * self.cosine,
        )

    def push(self) -> tuple[Expression, Expression, Expression]:
        """Return the force ahead and to the left and the moment about the rear axle's middle."""
        force_ahead, force_left = self.tyre.force_ahead(), self.tyre.force_left()
        ahead = force_ahead * self.cosine - force_left * self.sine
        left = force_ahead * self.sine + force_left * self.cosine
        return ahead, left, P["wheelbase"] * left - self.lateral * ahead

    def spring_ahead(self) -> Expression:
        """Return the spring's force along the platform, for the load transfer."""
        return self.tyre.spring_ahead * self.cosine - self.tyre.spring_left * self.sine

    def states(
        self,
        resistance: Expression,
        start: tuple[Expression, Expression, Expression],
        side_force: Expression,
        load: Expression,
    ) -> tuple[State, ...]:
        """Return spin and tyre: I_w w' = - r F_s - bearing (3.84); it starts rolling with the platform."""
        torque = -P["front_radius"] * self.tyre.force_ahead() - resistance * self.friction
        hub, swing = self._kingpin(start)
        rolling = hub * self.cosine + swing * self.sine
        return (
            State(
                f"spin_{self.name}", "rad/s", rolling / P["front_radius"], torque / P["front_spin_inertia"]
            ),
            State(
                f"rolling_{self.name}",
                "1",
                sp.S.Zero,
                bristle(self.spin, self.friction, P["rolling_presliding"]),
            ),
            *self.tyre.states((sp.S.Zero, side_force), load),
        )

    def energy(self, resistance: Expression) -> Expression:
        """Return the energy of spin, bearing and tyre in J."""
        dry = resistance * P["rolling_presliding"] * self.friction**2
        return HALF * (P["front_spin_inertia"] * self.spin**2 + dry) + self.tyre.energy()

    def _kingpin(self, motion: tuple[Expression, Expression, Expression]) -> tuple[Expression, Expression]:
        """Return the kingpin's speed ahead and to the left along the platform."""
        speed, drift, yaw_rate = motion
        return speed - yaw_rate * self.lateral, drift + yaw_rate * P["wheelbase"]


class Platform:
    """u ahead and q to the left of the rear axle's middle, W the yaw rate to the left."""

    def __init__(self, left: Shaft, right: Shaft, steering: Steering) -> None:
        self.rear = {"left": left, "right": right}
        self.heading = symbol("heading")
        self.speed, self.drift, self.yaw_rate = self.motion = tuple(
            map(symbol, ("speed", "drift", "yaw_rate"))
        )
        self.offset_mass = P["platform_mass"] * P["centre_offset"]
        self.total_mass = P["platform_mass"] + 2 * P["wheel_mass"]
        self.axle_inertia = (
            P["yaw_inertia"]
            + 2 * P["wheel_yaw_inertia"]
            + self.offset_mass * P["centre_offset"]
            + 2 * P["wheel_mass"] * (P["rear_track"] / 2) ** 2
        )
        self.fronts = {side: Front(side, steering, (self.speed, self.drift, self.yaw_rate)) for side in SIDES}
        self.rears = {
            side: Tyre(
                f"rear_{side}",
                rim=P["wheel_radius"] * shaft.speed / shaft.gear,
                back=self.yaw_rate * SIDES[side] * P["rear_track"] / 2 - self.speed,
                right=-self.drift,
            )
            for side, shaft in self.rear.items()
        }
        self._load_tyres()

    def shaft_acceleration(self, side: str) -> Expression:
        """Return a wheel motor's acceleration: I_w w' = tau - r F_s, (3.73) with the moment that it lacks."""
        shaft, tyre = self.rear[side], self.rears[side]
        resistance = self._resistance(self.rear_load) * shaft.friction
        at_wheel = resistance + P["wheel_radius"] * tyre.force_ahead()
        return (shaft.torque - at_wheel / shaft.gear) / (
            shaft.inertia + P["wheel_spin_inertia"] / shaft.gear**2
        )

    def states(self) -> tuple[State, ...]:
        """Return motion, pose, front wheels and tyres; it starts rolling as the rear wheels turn."""
        left, right = (shaft.speed / shaft.gear for shaft in self.rear.values())
        rolling = P["wheel_radius"] * (left + right) * HALF
        turning = P["wheel_radius"] * (right - left) / P["rear_track"]  # (5.1) corrected: right minus left
        speed_rate, drift_rate, yaw_acceleration = self._accelerations()
        sine, cosine = sp.sin(self.heading), sp.cos(self.heading)
        start = (rolling, sp.S.Zero, turning)
        resistance = self._resistance(self.front_load)
        uphill, left_front, left_rear = self._hold()
        shift = P["cg_height"] / P["wheelbase"] * uphill
        return (
            State("x", "m", sp.S.Zero, self.speed * cosine - self.drift * sine),
            State("y", "m", sp.S.Zero, self.speed * sine + self.drift * cosine),
            State("heading", "rad", sp.S.Zero, self.yaw_rate),
            State("speed", "m/s", rolling, speed_rate),
            State("drift", "m/s", sp.S.Zero, drift_rate),
            State("yaw_rate", "rad/s", turning, yaw_acceleration),
            *(
                state
                for front in self.fronts.values()
                for state in front.states(resistance, start, left_front, self.front_load - shift)
            ),
            *(
                state
                for tyre in self.rears.values()
                for state in tyre.states((uphill, left_rear), self.rear_load + shift)
            ),
        )

    def tyres(self) -> tuple[Tyre, ...]:
        """Return all four, rear and front, left and right."""
        return (*self.rears.values(), *(front.tyre for front in self.fronts.values()))

    def energy(self) -> Expression:
        """Return the energy of platform, wheels and tyres in J; the rotors' own is the shafts'."""
        platform = self.total_mass * (self.speed**2 + self.drift**2) + self.axle_inertia * self.yaw_rate**2
        platform += 2 * self.offset_mass * self.drift * self.yaw_rate
        rolling = self._resistance(self.rear_load) * P["presliding"]
        for shaft in self.rear.values():
            platform += P["wheel_spin_inertia"] * (shaft.speed / shaft.gear) ** 2
            platform += rolling / shaft.gear * shaft.friction**2
        climb = self.total_mass * symbol("x") + self.offset_mass * sp.cos(self.heading)
        wheels = sum(front.energy(self._resistance(self.front_load)) for front in self.fronts.values())
        wheels += sum(tyre.energy() for tyre in self.rears.values())
        return HALF * platform + P["gravity"] * sp.sin(P["slope"]) * climb + wheels

    def _load_tyres(self) -> None:
        """Share the weight: static pairs, and what the forces at the floor shift by Z_cg (2.2)."""
        weight = P["gravity"] * sp.cos(P["slope"])
        self.front_load = weight * self.offset_mass / P["wheelbase"] * HALF
        self.rear_load = weight * self.total_mass * HALF - self.front_load
        pull = sum(tyre.spring_ahead for tyre in self.rears.values())
        pull += sum(front.spring_ahead() for front in self.fronts.values())
        shift = P["cg_height"] / P["wheelbase"] * HALF * pull
        for tyre in self.rears.values():
            tyre.bears(self.rear_load + shift)
        for front in self.fronts.values():
            front.tyre.bears(self.front_load - shift)

    def _resistance(self, load: Expression) -> Expression:
        """Return one wheel's rolling resistance in N.m, from its static load (ASSUME)."""
        return P["rolling_resistance"] * load * P["wheel_radius"]

    def _hold(self) -> tuple[Expression, Expression, Expression]:
        """Return what holds it on its slope at the start: a rear wheel ahead, a front, a rear one aside."""
        downhill = P["gravity"] * sp.sin(P["slope"])
        front = self.offset_mass / P["wheelbase"]
        aside = -downhill * sp.sin(self.heading) * HALF
        return (
            self.total_mass * downhill * sp.cos(self.heading) * HALF,
            front * aside,
            (self.total_mass - front) * aside,
        )

    def friction_start(self, side: str) -> Expression:
        """Return the bristle of a wheel motor that holds the robot on its slope, -1..1."""
        shaft = self.rear[side]
        level = shaft.coulomb + self._resistance(self.rear_load) / shaft.gear
        uphill = self._hold()[0]
        load = self.rear_load + P["cg_height"] / P["wheelbase"] * uphill
        held = clamped(uphill, P["floor_friction"] * load) * P["wheel_radius"] / shaft.gear
        return -clamped(held, level) / (level + TRACE)

    def _accelerations(self) -> tuple[Expression, Expression, Expression]:
        """Return u', q', W'.

        m_t (u' - q W) - m_p a W2 = F_u, m_t (q' + u W) + m_p a W' = F_q, I_O W' + m_p a (q' + u W) = F_W: the
        convective terms that [R] 3.3.2 takes as zero do not vanish, because a is not zero.
        """
        weight = P["gravity"] * sp.sin(P["slope"])  # (3.44) corrected: the mass was missing
        sine, cosine = sp.sin(self.heading), sp.cos(self.heading)
        ahead = self.offset_mass * self.yaw_rate**2 - self.total_mass * weight * cosine
        left = self.total_mass * weight * sine
        around = self.offset_mass * weight * sine
        for side, tyre in self.rears.items():
            force = tyre.force_ahead()
            ahead += force
            left += tyre.force_left()
            around -= SIDES[side] * P["rear_track"] / 2 * force
        for front in self.fronts.values():
            pushes = front.push()
            ahead, left, around = ahead + pushes[0], left + pushes[1], around + pushes[2]
        determinant = self.total_mass * self.axle_inertia - self.offset_mass**2
        return (
            ahead / self.total_mass + self.drift * self.yaw_rate,
            self.axle_inertia / determinant * left
            - self.offset_mass / determinant * around
            - self.speed * self.yaw_rate,
            self.total_mass / determinant * around - self.offset_mass / determinant * left,
        )
