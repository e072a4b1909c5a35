"""The platform on four tyres: two driven rear wheels, two steered front wheels, a slope, [R] 3.3, 3.4."""

import sympy as sp

from fmu.export.functions import clamped, reciprocal, shared
from fmu.export.model import Event, Expression, Output, StateVariable
from fmu.parts.motor import Shaft, bristle
from fmu.parts.planar import PlanarBody, Push
from fmu.parts.symbols import HALF, symbol
from fmu.parts.tyre import TRACE, Tyre
from fmu.parts.wheel import DrivenWheel
from fmu.rars.steering import Steering
from fmu.rars.symbols import P

LEFT, RIGHT = 1, -1
SIDES = {"left": LEFT, "right": RIGHT}


class Front:
    """A steered wheel that rolls freely: where it points, how it moves, what its tyre does."""

    def __init__(self, side: str, steering: Steering, body: PlanarBody, tyre: type[Tyre] = Tyre) -> None:
        self.name = f"front_{side}"
        self.spin, self.friction = symbol(f"spin_{self.name}"), symbol(f"rolling_{self.name}")
        self.lateral = SIDES[side] * P["kingpin_distance"] / 2
        across, along = steering.direction(SIDES[side])
        per_length = reciprocal(sp.sqrt(across**2 + along**2))
        self.sine, self.cosine = shared(across * per_length), shared(along * per_length)
        hub, swing = body.velocity(P["wheelbase"], self.lateral)
        self.tyre = tyre(
            self.name,
            P,
            rim=P["front_radius"] * self.spin,
            back=-hub * self.cosine - swing * self.sine,
            right=hub * self.sine - swing * self.cosine,
        )

    def push(self) -> Push:
        """Return what the floor does to the platform."""
        force_ahead, force_left = self.tyre.force_ahead(), self.tyre.force_left()
        ahead = force_ahead * self.cosine - force_left * self.sine
        left = force_ahead * self.sine + force_left * self.cosine
        return Push(ahead, left, P["wheelbase"] * left - self.lateral * ahead)

    def spring_ahead(self) -> Expression:
        """Return the spring's force along the platform, for the load transfer."""
        return self.tyre.spring_ahead * self.cosine - self.tyre.spring_left * self.sine

    def states(
        self,
        resistance: Expression,
        start: tuple[Expression, Expression],
        side_force: Expression,
        load: Expression,
    ) -> tuple[StateVariable, ...]:
        """Return spin and tyre: I_w w' = - r F_s - bearing (3.84); it starts rolling with the platform."""
        torque = -P["front_radius"] * self.tyre.force_ahead() - resistance * self.friction
        speed, yaw_rate = start
        hub, swing = speed - yaw_rate * self.lateral, yaw_rate * P["wheelbase"]
        rolling = hub * self.cosine + swing * self.sine
        return (
            StateVariable(
                f"spin_{self.name}", "rad/s", rolling / P["front_radius"], torque / P["front_spin_inertia"]
            ),
            StateVariable(
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


class Platform:
    """u ahead and q to the left of the rear axle's middle, W the yaw rate to the left."""

    tyre: type[Tyre] = Tyre
    body_type: type[PlanarBody] = PlanarBody

    def __init__(self, left: Shaft, right: Shaft, steering: Steering) -> None:
        self._downhill = P["gravity"] * sp.sin(P["slope"])  # (3.44) corrected: the mass was missing
        self.offset_mass = P["platform_mass"] * P["centre_offset"]
        self.total_mass = P["platform_mass"] + 2 * P["wheel_mass"]
        # The convective terms that [R] 3.3.2 takes as zero do not vanish, because the offset is not zero.
        self.body = self.body_type(
            mass=self.total_mass,
            offset_mass=self.offset_mass,
            inertia=P["yaw_inertia"]
            + 2 * P["wheel_yaw_inertia"]
            + self.offset_mass * P["centre_offset"]
            + 2 * P["wheel_mass"] * (P["rear_track"] / 2) ** 2,
            downhill=self._downhill,
        )
        weight = P["gravity"] * sp.cos(P["slope"])
        self.front_load = weight * self.offset_mass / P["wheelbase"] * HALF
        self.rear_load = weight * self.total_mass * HALF - self.front_load
        self.fronts = {side: Front(side, steering, self.body, self.tyre) for side in SIDES}
        self.rears = {
            side: DrivenWheel(
                f"rear_{side}",
                P,
                shaft,
                self.body,
                left=SIDES[side] * P["rear_track"] / 2,
                radius=P["wheel_radius"],
                spin_inertia=P["wheel_spin_inertia"],
                resistance=self._resistance(self.rear_load),
                tyre=self.tyre,
            )
            for side, shaft in {"left": left, "right": right}.items()
        }
        self._load_tyres()

    def shaft_acceleration(self, side: str) -> Expression:
        """Return a wheel motor's acceleration, (3.73) with the moment that it lacks."""
        return self.rears[side].acceleration()

    def states(self) -> tuple[StateVariable, ...]:
        """Return motion, pose, front wheels and tyres; it starts rolling as the rear wheels turn."""
        left, right = (wheel.shaft.speed / wheel.shaft.gear for wheel in self.rears.values())
        start = (
            P["wheel_radius"] * (left + right) * HALF,
            P["wheel_radius"] * (right - left) / P["rear_track"],  # (5.1) corrected: right minus left
        )
        resistance = self._resistance(self.front_load)
        uphill, left_front, left_rear = self._hold()
        # On a slope the rear wheels carry more from the start.
        shift = P["cg_height"] / P["wheelbase"] * uphill
        return (
            *self.body.states(self.pushes(), start),
            *(
                state
                for front in self.fronts.values()
                for state in front.states(resistance, start, left_front, self.front_load - shift)
            ),
            *(
                state
                for wheel in self.rears.values()
                for state in wheel.tyre.states((uphill, left_rear), self.rear_load + shift)
            ),
        )

    def tyres(self) -> tuple[Tyre, ...]:
        """Return all four, rear and front, left and right."""
        return (
            *(wheel.tyre for wheel in self.rears.values()),
            *(front.tyre for front in self.fronts.values()),
        )

    def energy(self) -> Expression:
        """Return the energy of platform, wheels and tyres in J; the rotors' own is the shafts'."""
        wheels = sum(front.energy(self._resistance(self.front_load)) for front in self.fronts.values())
        wheels += sum(wheel.energy() for wheel in self.rears.values())
        return self.body.energy() + wheels

    def pushes(self) -> list[Push]:
        """Return what the floor does to the platform, rear wheels first."""
        rears = [wheel.push() for wheel in self.rears.values()]
        return rears + [front.push() for front in self.fronts.values()]

    def readings(self) -> tuple[Output, ...]:
        """Return what another platform has to be read beside."""
        return ()

    def events(self) -> tuple[Event, ...]:
        """Return what another platform meets."""
        return ()

    def _load_tyres(self) -> None:
        """Share the weight: static pairs, and what the forces at the floor shift by Z_cg (2.2)."""
        pull = sum(wheel.tyre.spring_ahead for wheel in self.rears.values())
        pull += sum(front.spring_ahead() for front in self.fronts.values())
        shift = P["cg_height"] / P["wheelbase"] * HALF * pull
        for wheel in self.rears.values():
            wheel.tyre.bears(self.rear_load + shift)
        for front in self.fronts.values():
            front.tyre.bears(self.front_load - shift)

    def _resistance(self, load: Expression) -> Expression:
        """Return one wheel's rolling resistance in N.m, from its static load (assumed)."""
        return P["rolling_resistance"] * load * P["wheel_radius"]

    def _hold(self) -> tuple[Expression, Expression, Expression]:
        """Return what holds it on its slope at the start: a rear wheel ahead, a front, a rear one aside."""
        front = self.offset_mass / P["wheelbase"]
        aside = -self._downhill * sp.sin(self.body.heading) * HALF
        return (
            self.total_mass * self._downhill * sp.cos(self.body.heading) * HALF,
            front * aside,
            (self.total_mass - front) * aside,
        )

    def friction_start(self, side: str) -> Expression:
        """Return the bristle of a wheel motor that holds the robot on its slope, -1..1."""
        shaft = self.rears[side].shaft
        level = shaft.coulomb + self._resistance(self.rear_load) / shaft.gear
        uphill = self._hold()[0]
        load = self.rear_load + P["cg_height"] / P["wheelbase"] * uphill
        held = clamped(uphill, P["floor_friction"] * load) * P["wheel_radius"] / shaft.gear
        return -clamped(held, level) / (level + TRACE)
