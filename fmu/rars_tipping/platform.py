"""The platform on four tires that follow their loads: it stands on them, lifts off them, and tips over."""

import sympy as sp

from fmu.export.functions import clamped, larger, named, passed, size
from fmu.export.model import Event, Expression, Output, StateVariable
from fmu.parts.motor import Shaft
from fmu.parts.symbols import HALF, inner
from fmu.parts.tyre import TRACE, Tyre
from fmu.parts.wheel import DrivenWheel
from fmu.rars.lift import Lift
from fmu.rars.platform import SIDES, Front
from fmu.rars.steering import Steering
from fmu.rars_tipping import support
from fmu.rars_tipping.body import LoadedBody
from fmu.rars_tipping.masses import Masses
from fmu.rars_tipping.rocking import Rocking
from fmu.rars_tipping.symbols import P


class TippingPlatform:
    """Body, wheels and rotation of RARS; u ahead, q to the left of the rear axle's middle, W to the left."""

    def __init__(self, left: Shaft, right: Shaft, steering: Steering, lift: Lift) -> None:
        self.masses = masses = Masses(lift.height)
        self.weight = masses.total * P["gravity"] * sp.cos(P["slope"])
        self.pitch, self.roll = (
            Rocking(name, centre, masses.height, mass=masses.total, inertia=masses.rocking_inertia(P[of]))
            for name, centre, of in (
                ("pitch", masses.ahead, "pitch_inertia"),
                ("roll", masses.left, "roll_inertia"),
            )
        )
        self._past_tip = larger(size(self.pitch.angle), size(self.roll.angle)) - P["tip_angle"]
        self.tipped = passed(self._past_tip)
        self.body = LoadedBody(masses, self.tipped)
        front = masses.ahead / P["wheelbase"]
        # On a standing robot with its load in the middle; for what rolls, as in fmu/rars (assumed).
        self._static = {"front": self.weight * front * HALF, "rear": self.weight * (1 - front) * HALF}
        self.fronts = {side: Front(side, steering, self.body) for side in SIDES}
        self.rears = {
            side: DrivenWheel(
                f"rear_{side}",
                P,
                shaft,
                self.body,
                left=SIDES[side] * P["rear_track"] / 2,
                radius=P["wheel_radius"],
                spin_inertia=P["wheel_spin_inertia"],
                resistance=self._resistance("rear"),
            )
            for side, shaft in {"left": left, "right": right}.items()
        }
        self._stand()

    def shaft_acceleration(self, side: str) -> Expression:
        """Return a wheel motor's acceleration in rad/s2."""
        return self.rears[side].acceleration()

    def friction_start(self, side: str) -> Expression:
        """Return the bristle of a wheel motor that holds the robot on its slope, -1..1."""
        shaft = self.rears[side].shaft
        level = shaft.coulomb + self._resistance("rear") / shaft.gear
        load = self._start_loads()[f"rear_{side}"]
        uphill = self._hold()[f"rear_{side}"][0]
        held = clamped(uphill, P["floor_friction"] * load) * P["wheel_radius"] / shaft.gear
        return -clamped(held, level) / (level + TRACE)

    def states(self) -> tuple[StateVariable, ...]:
        """Return motion, pose, wheels, tires and rotation; it starts rolling as the rear wheels turn."""
        left, right = (wheel.shaft.speed / wheel.shaft.gear for wheel in self.rears.values())
        start = (
            P["wheel_radius"] * (left + right) * HALF,
            P["wheel_radius"] * (right - left) / P["rear_track"],
        )
        hold, loads, resistance = self._hold(), self._start_loads(), self._resistance("front")
        pushes = [wheel.push() for wheel in self.rears.values()]
        pushes += [front.push() for front in self.fronts.values()]
        return (
            *self.body.states(pushes, start),
            *(
                state
                for front in self.fronts.values()
                for state in front.states(resistance, start, hold[front.name][1], loads[front.name])
            ),
            *(
                state
                for wheel in self.rears.values()
                for state in wheel.tyre.states(hold[wheel.tyre.name], loads[wheel.tyre.name])
            ),
            *self.roll.states(self.tipped),
            *self.pitch.states(self.tipped),
        )

    def tyres(self) -> dict[str, Tyre]:
        """Return all four by their names, rear and front, left and right."""
        wheels = [wheel.tyre for wheel in self.rears.values()] + [it.tyre for it in self.fronts.values()]
        return {tyre.name: tyre for tyre in wheels}

    def margin(self) -> Expression:
        """Return the distance of the ZMP from the nearest edge of the support in m, negative outside."""
        return support.margin(self.pitch.zmp, self.roll.zmp)

    def events(self) -> tuple[Event, ...]:
        """Return where a wheel lifts, and where the robot has tipped over."""
        return (
            Event("past_edge", "m", "ZMP past the nearest edge of the support", -self.margin()),
            Event("past_tip_angle", "rad", "roll or pitch past the angle of tip-over", self._past_tip),
        )

    def energy(self) -> Expression:
        """Return the energy of platform, wheels and tires in J; the rotors' own is the shafts'."""
        wheels = sum(front.energy(self._resistance("front")) for front in self.fronts.values())
        wheels += sum(wheel.energy() for wheel in self.rears.values())
        return self.body.energy() + wheels + self.roll.energy() + self.pitch.energy()

    def sensed(self) -> tuple[Output, ...]:
        """Return the specific force at the centre of mass in the body's axes, as an accelerometer has it.

        The rotation's own accelerations are left out (assumed): 0 while all wheels are loaded.
        """
        total = self.masses.total
        pushes = [wheel.push() for wheel in self.rears.values()]
        pushes += [front.push() for front in self.fronts.values()]
        ahead, left = (sum(getattr(it, way) for it in pushes) / total for way in ("ahead", "left"))
        up = self.weight / total
        across, along = self.roll.angle, self.pitch.angle
        raised = up * sp.cos(across) - left * sp.sin(across)
        return (
            inner(
                "specific_force_ahead",
                "m/s2",
                "specific force along the body's long axis",
                ahead * sp.cos(along) + raised * sp.sin(along),
            ),
            inner(
                "specific_force_left",
                "m/s2",
                "specific force along the body's axis to the left",
                left * sp.cos(across) + up * sp.sin(across),
            ),
            inner(
                "specific_force_up",
                "m/s2",
                "specific force along the body's axis up",
                raised * sp.cos(along) - ahead * sp.sin(along),
            ),
        )

    def _stand(self) -> None:
        """Share the weight by the ZMP of what the tires' springs push (2.2), as the robot leans now."""
        springs = {name: (tyre.spring_ahead, tyre.spring_left) for name, tyre in self.tyres().items()}
        loads = self._carried(springs)
        # Once more: the spring of a wheel that slips without load is bent, and pushes no more than it grips.
        grips = {name: P["floor_friction"] * load for name, load in loads.items()}
        held = {
            name: (clamped(along, grips[name]), clamped(across, grips[name]))
            for name, (along, across) in springs.items()
        }
        loads = self._carried(held)
        for name, tyre in self.tyres().items():
            # What lies on the floor has no load on its wheels.
            tyre.bears((1 - self.tipped) * loads[name])

    def _carried(self, pushes: dict[str, tuple[Expression, Expression]]) -> dict[str, Expression]:
        """Return the wheels' loads in N under these pushes along each wheel's way and axle.

        Of the springs, without the dampers, which depend on the loads that follow from it.
        """
        ahead, left = (sum(pushes[wheel.tyre.name][way] for wheel in self.rears.values()) for way in (0, 1))
        for front in self.fronts.values():
            along, across = pushes[front.name]
            ahead += along * front.cosine - across * front.sine
            left += along * front.sine + across * front.cosine
        self.pitch.stands(sp.S.Zero, P["wheelbase"], force=named(ahead), weight=self.weight)
        half = named(support.half_width(self.pitch.contact))
        self.roll.stands(-half, half, force=named(left), weight=self.weight)
        return support.loads(self.weight, self.pitch.contact, self.roll.contact)

    def _start_loads(self) -> dict[str, Expression]:
        """Return the wheels' loads of the robot that stands on its slope."""
        ahead, left = self._held()
        per_weight = self.masses.height / self.weight
        place = self.masses.ahead - per_weight * ahead, self.masses.left - per_weight * left
        return support.loads(self.weight, *support.within(*place))

    def _resistance(self, axle: str) -> Expression:
        """Return one wheel's rolling resistance in N.m, from its static load (assumed)."""
        return P["rolling_resistance"] * self._static[axle] * P["wheel_radius"]

    def _held(self) -> tuple[Expression, Expression]:
        """Return the forces ahead and to the left that hold it on its slope, in N."""
        pull = self.masses.total * self.body.downhill
        return pull * self.body.uphill_ahead, -pull * self.body.uphill_right

    def _hold(self) -> dict[str, tuple[Expression, Expression]]:
        """Return what each wheel gives ahead and aside: its share of its axle's load, of its axle's part."""
        ahead, left = self._held()
        front = self.masses.ahead / P["wheelbase"]
        found: dict[str, tuple[Expression, Expression]] = {}
        for axle, along, across in (("rear", ahead, (1 - front) * left), ("front", sp.S.Zero, front * left)):
            loads = {side: self._start_loads()[f"{axle}_{side}"] for side in SIDES}
            whole = sum(loads.values()) + TRACE
            found |= {
                f"{axle}_{side}": (along * it / whole, across * it / whole) for side, it in loads.items()
            }
        return found
