"""A survey: drive to a point, stand, lift, read a detector, lower, go on to the next point.

Source: A. P. Das, PhD thesis, IIT Delhi, 2018, chapter 1 and 2.1: readings of a radiation detector at points
that the operator chooses, each at several heights. Every command passes the bridge's interlocks as a hand's
does: it drives with the table down, and lifts at standstill.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from enum import Enum
from typing import Final, NamedTuple

from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.driver import NEUTRAL, DriveCommand, Sight
from firmware_bridge.pilot.follower import PathDriver
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.paths import Point
from firmware_bridge.units import SECOND, Nanoseconds

STANDS_MPS: Final = 0.005
STANDS_FOR: Final[Nanoseconds] = SECOND
"""Time of standstill before it lifts, and with the table down before it drives on."""
AT_HEIGHT_M: Final = 0.002
RESTS_FOR: Final[Nanoseconds] = SECOND // 2
"""Time at the height, with the detector switched on, before it reads."""
REFUSED_FOR: Final[Nanoseconds] = 5 * SECOND
"""Time without a path after which a point is left out: what the robot can drive may come late."""
PATIENCE: Final[Nanoseconds] = 60 * SECOND
"""Time of lifting after which a height counts as out of reach."""
ORDERED_EVERY: Final[Nanoseconds] = 10 * SECOND
"""Interval of the same order while the robot does not report what it leads to."""


class Phase(Enum):
    """What a survey does."""

    DRIVES = "drives to its point"
    STANDS = "stands"
    LIFTS = "lifts"
    READS = "reads"
    LOWERS = "lowers"
    ENDED = "has ended"


@dataclass(frozen=True, slots=True)
class Plan:
    """Points in m, ahead and to the left of where it begins; heights in m above the lowest."""

    points: tuple[Point, ...]
    heights_m: tuple[float, ...]
    reads: Nanoseconds


class Reading(NamedTuple):
    """One reading: where the robot believes that it stands, and from when to when."""

    point: int
    """Counted from 0."""
    pose: Pose
    height_m: float
    begins: Nanoseconds
    ends: Nanoseconds


@dataclass(frozen=True, slots=True)
class Table:
    """What lifts the detector and switches it on: orders, as a height by stick swings over a slow link."""

    height: str
    """Name of the value with the height in m above the lowest."""
    reported: str
    """Name of the value that is 1 while the detector is switched on."""
    to_height: Callable[[float, Nanoseconds], None]
    """Order the table to a height in m above the lowest."""
    switch: Callable[[bool, Nanoseconds], None]
    """Order the detector on or off."""


class SurveyDriver:
    """A `firmware_bridge.pilot.driver.Driver`."""

    def __init__(
        self,
        plan: Plan,
        table: Table,
        legs: Callable[[Point], PathDriver],
        values: Callable[[], Mapping[str, float]],
    ) -> None:
        """Survey by a plan; `legs` make a follower to a point, `values` are the robot's newest ones."""
        self._plan: Final = plan
        self._table: Final = table
        self._legs: Final = legs
        self._values: Final = values
        self.phase = Phase.DRIVES
        self.readings: Final[list[Reading]] = []
        self.refused: Final[dict[int, str]] = {}
        """Why there is no reading of a point, or not of all heights, by its number."""
        self._point = self._height = 0
        self._leg: PathDriver | None = None
        self._sight: Sight | None = None
        self._since: Nanoseconds = 0
        """Time when the phase began, or when it last moved while it stands."""
        self._away_at: Nanoseconds = 0
        """Time when it was last not at its height."""
        self._ordered_at: Nanoseconds | None = None
        """Time of the last order of this phase; None before."""
        self._next: Final = {
            Phase.DRIVES: self._drive,
            Phase.STANDS: self._stand,
            Phase.LIFTS: self._lift,
            Phase.READS: self._read,
            Phase.LOWERS: self._lower,
            Phase.ENDED: self._end,
        }

    def sees(self, sight: Sight) -> None:
        """Take a pose that has come."""
        self._sight = sight
        if self._leg is not None:
            self._leg.sees(sight)

    def command(self, link: PilotLink, now: Nanoseconds, *, armed: bool) -> DriveCommand:
        """Return what leads on; at rest while the robot is not armed, or not seen."""
        if not armed or self._sight is None:
            # Armed again it begins its phase again, with its orders: the robot has forgotten them.
            self._since, self._away_at, self._ordered_at = now, now, None
            return NEUTRAL if self._leg is None else self._leg.command(link, now, armed=False)
        return self._next[self.phase](link, now)

    def _drive(self, link: PilotLink, now: Nanoseconds) -> DriveCommand:
        if self._leg is None:
            self._leg = self._legs(self._plan.points[self._point])
            if self._sight is not None:
                self._leg.sees(self._sight)
        command = self._leg.command(link, now, armed=True)
        if self._leg.refused and now - self._since >= REFUSED_FOR:
            self.refused[self._point] = self._leg.refused
            self._go_on(now)
        elif self._leg.arrived:
            self._to(Phase.STANDS, now)
        return command

    def _stand(self, _link: PilotLink, now: Nanoseconds) -> DriveCommand:
        if self._sight is None or abs(self._sight.moving.speed_mps) > STANDS_MPS:
            self._since = now
        elif now - self._since >= STANDS_FOR:
            self._to(Phase.LIFTS, now)
        return NEUTRAL

    def _lift(self, _link: PilotLink, now: Nanoseconds) -> DriveCommand:
        wanted = self._plan.heights_m[self._height]
        if self._waited(now, f"{wanted:g} m was not reached"):
            return NEUTRAL
        if not (self._at(wanted) and self._detecting(on=True)):
            self._away_at = now
        elif now - self._away_at >= RESTS_FOR:
            self._to(Phase.READS, now)
            return NEUTRAL
        self._order(wanted, now, on=True)
        return NEUTRAL

    def _read(self, _link: PilotLink, now: Nanoseconds) -> DriveCommand:
        if now - self._since < self._plan.reads or self._sight is None:
            return NEUTRAL
        height = self._values().get(self._table.height, 0.0)
        self.readings.append(Reading(self._point, self._sight.moving.pose, height, self._since, now))
        self._height += 1
        self._to(Phase.LIFTS if self._height < len(self._plan.heights_m) else Phase.LOWERS, now)
        return NEUTRAL

    def _lower(self, _link: PilotLink, now: Nanoseconds) -> DriveCommand:
        if self._at(0.0) and self._detecting(on=False):
            self._go_on(now)
        else:
            self._order(0.0, now, on=False)
        return NEUTRAL

    def _end(self, _link: PilotLink, _now: Nanoseconds) -> DriveCommand:
        return NEUTRAL

    def _go_on(self, now: Nanoseconds) -> None:
        self._point, self._height, self._leg = self._point + 1, 0, None
        self._to(Phase.DRIVES if self._point < len(self._plan.points) else Phase.ENDED, now)

    def _to(self, phase: Phase, now: Nanoseconds) -> None:
        self.phase, self._since, self._away_at, self._ordered_at = phase, now, now, None

    def _waited(self, now: Nanoseconds, why: str) -> bool:
        """Return whether a height has been waited for too long; then it is lowered."""
        if now - self._since < PATIENCE:
            return False
        self.refused[self._point] = why
        self._to(Phase.LOWERS, now)
        return True

    def _at(self, height_m: float) -> bool:
        return abs(self._values().get(self._table.height, float("nan")) - height_m) <= AT_HEIGHT_M

    def _order(self, height_m: float, now: Nanoseconds, *, on: bool) -> None:
        """Order height and detector, and again where nothing comes of it for long."""
        if self._ordered_at is not None and now - self._ordered_at < ORDERED_EVERY:
            return
        self._ordered_at = now
        self._table.to_height(height_m, now)
        self._table.switch(on, now)

    def _detecting(self, *, on: bool) -> bool:
        return (self._values().get(self._table.reported) == 1.0) is on
