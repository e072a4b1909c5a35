"""ROME's two halves in its robot file, how one bears the other, and its orbit."""

from math import radians
from typing import Annotated, Final, Self

from pydantic import Field, model_validator

from firmware_bridge import renamed
from firmware_bridge.motion.orbit import OrbitState, state
from firmware_bridge.motion.orbit_elements import Elements as OrbitElements
from firmware_bridge.motion.orbit_elements import state_of
from firmware_bridge.motion.orbit_tle import state_of_tle
from firmware_bridge.robot.table import Finite, Positive, Table
from firmware_bridge.robots.ar2 import geometry as arm
from firmware_bridge.robots.rome import geometry as base

CENTRE: Final = (0.0, 0.0, 0.0)


class Balance(Table):
    """Masses and their positions: the common center of gravity stays inside the wheels' triangle."""

    base_kg: Positive
    """With what of the arm does not turn."""
    base_height_m: Positive
    """Of the base's middle of mass above the floor."""
    arm_height_m: Positive
    """Of the arm's foot, which stands at the base's middle."""
    link_kg: Annotated[tuple[Positive, ...], Field(strict=False, min_length=6, max_length=6)]
    """Each in the middle between its joints."""
    margin_m: Positive
    """So far inside the triangle it stays."""
    tool_distance_m: Positive
    """The base drives while the tool is no further from the first axis."""


class Elements(Table):
    """An orbit by its six elements."""

    axis_du: Finite
    """The semi-major axis; below 0 for a hyperbola."""
    eccentricity: Annotated[Finite, Field(ge=0.0)]
    inclination_deg: Finite = 0.0
    node_deg: Finite = 0.0
    periapsis_deg: Finite = 0.0
    """From the node."""
    anomaly_deg: Finite = 0.0
    """The true one, from the periapsis: where the body begins."""


class Orbit(Table):
    """Path follower `orbit`: a body about the Earth, with x and y on the floor and z by the arm (2.4).

    It is given by its place and speed, by its elements, or by a two-line element set.
    """

    start_du: Annotated[tuple[Finite, Finite, Finite] | None, Field(strict=False)] = None
    speed_du_tu: Annotated[tuple[Finite, Finite, Finite] | None, Field(strict=False)] = None
    kepler: Elements | None = None
    tle: Annotated[tuple[str, str] | None, Field(strict=False)] = None
    """Both lines, as they are; with the extra `orbit`."""
    tle_s: Finite = 0.0
    """The body begins so long after the set's epoch, and goes on from there as two bodies do."""
    m_per_du: Positive
    height_per_du: Positive
    s_per_tu: Positive = 1.0
    """Time scale of the path, where the base cannot follow so fast."""
    sideways_m: Annotated[tuple[Finite, Finite], Field(strict=False)] = (0.0, 0.0)
    """From where the orbit begins to where the base stands then."""

    @model_validator(mode="after")
    def _begins_somewhere(self) -> Self:
        given = (self.start_du, self.kepler, self.tle)
        whole = (self.start_du is None) is (self.speed_du_tu is None)
        if sum(it is not None for it in given) != 1 or not whole:
            raise ValueError("needs one of: start_du with speed_du_tu, kepler, tle")
        if self.tle is None and self.tle_s:
            raise ValueError("tle_s: only a set of two lines, tle, has an epoch")
        # There the attraction has no direction, and no bound.
        if not self.begin.place.any():
            raise ValueError("start_du: an orbit's body is not at its center")
        return self

    @property
    def begin(self) -> OrbitState:
        """Start state of the body, position and speed, in DU and DU/TU."""
        if self.tle is not None:
            # SGP4 counts minutes from the set's epoch.
            return state_of_tle(*self.tle, self.tle_s / 60.0)
        if self.kepler is not None:
            it = self.kepler
            angles = map(radians, (it.inclination_deg, it.node_deg, it.periapsis_deg, it.anomaly_deg))
            return state_of(OrbitElements(it.axis_du, it.eccentricity, *angles))
        return state(self.start_du or CENTRE, self.speed_du_tu or CENTRE)


class Formation(Table):
    """Path follower `formation`: one body's motion as seen from another on a circle (Clohessy, Wiltshire)."""

    half_width_m: Positive
    """Of its ellipse, half its width away from the center; along its way it is twice as long."""
    height_m: Positive
    turn_s: Positive


class BasePose(Table):
    """Path follower `pose`: a place beside for the base; the tool has its own (`arm.courses.pose`)."""

    by_m: Annotated[tuple[Finite, Finite], Field(strict=False)]
    turn_deg: Finite


class RomeArmGeometry(Table):
    """The part of a robot file for base and arm together."""

    base: base.RomeGeometry
    arm: arm.Ar2Geometry
    balance: Balance
    orbit: Orbit
    formation: Formation
    pose: BasePose


__getattr__ = renamed.module(__name__, __name__, Geometry="RomeArmGeometry")
