"""A driven wheel that stands fixed in its body: motor, gear, rim, and a tire on the floor."""

from collections.abc import Mapping

from fmu.export.model import Expression
from fmu.parts.motor import Shaft
from fmu.parts.planar import PlanarBody, Push
from fmu.parts.symbols import HALF
from fmu.parts.tyre import Tyre


class DrivenWheel:
    """Wheel `left` of its body's origin (m) that points ahead; parameters are those of Tyre and Shaft."""

    def __init__(
        self,
        name: str,
        parameters: Mapping[str, Expression],
        shaft: Shaft,
        body: PlanarBody,
        *,
        left: Expression,
        radius: Expression,
        spin_inertia: Expression,
        resistance: Expression,
        tyre: type[Tyre] = Tyre,
    ) -> None:
        self.shaft, self.left, self.radius = shaft, left, radius
        self._spin_inertia, self._resistance = spin_inertia, resistance
        self._presliding = parameters["presliding"]
        ahead, aside = body.velocity(0, left)
        self.rim = radius * shaft.speed / shaft.gear
        self.tyre = tyre(name, parameters, rim=self.rim, back=-ahead, right=-aside)

    def acceleration(self) -> Expression:
        """Return the motor's acceleration: I_w w' = tau - r F_s."""
        shaft = self.shaft
        # The rolling resistance uses the shaft's bristle: both stop and turn round together.
        at_wheel = self._resistance * shaft.friction + self.radius * self.tyre.force_ahead()
        return (shaft.torque - at_wheel / shaft.gear) / (shaft.inertia + self._spin_inertia / shaft.gear**2)

    def push(self) -> Push:
        """Return what the floor does to the body."""
        force = self.tyre.force_ahead()
        return Push(force, self.tyre.force_left(), -self.left * force)

    def energy(self) -> Expression:
        """Return the energy of rim, rolling bristle and tire in J; the rotor's own is the shaft's."""
        shaft = self.shaft
        spin = self._spin_inertia * (shaft.speed / shaft.gear) ** 2
        bristle = self._resistance * self._presliding / shaft.gear * shaft.friction**2
        return HALF * (spin + bristle) + self.tyre.energy()
