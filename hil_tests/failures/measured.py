"""The worst that came of each cause of a stop, as `tools/measure_stops.py` has measured it."""

from dataclasses import dataclass
from typing import Final, Self

from hil_tests.failures.cases import CAUSES, LINKS, MOTIONS, Cause
from hil_tests.failures.drive import Came, Draw
from hil_tests.failures.kept import Kept


@dataclass(frozen=True, slots=True)
class Worst:
    """One row of the file."""

    cause: str
    link: str
    motion: str
    phase_ms: int
    way_mm: int
    rest_ms: int
    noticed_ms: int | None = None

    @classmethod
    def of(cls, cause: Cause, draw: Draw, came: Came) -> Self:
        """Return the row for what came of a draw."""
        begun = cause.name, draw.link, draw.motion.name, draw.phase_ms
        return cls(*begun, came.way_mm, came.rest_ms, came.noticed_ms)

    @property
    def drawn(self) -> tuple[Cause, Draw]:
        """How it was begun."""
        motion = next(motion for motion in MOTIONS if motion.name == self.motion)
        cause = next(cause for cause in CAUSES if cause.name == self.cause)
        return cause, Draw(self.link, motion, self.phase_ms)

    @property
    def came(self) -> Came:
        """What came of it."""
        return Came(self.way_mm, self.rest_ms, self.noticed_ms)

    @property
    def place(self) -> tuple[int, int, bool]:
        """Its place in the file."""
        cause, draw = self.drawn
        return CAUSES.index(cause), LINKS.index(draw.link), draw.motion.lifts


KEPT: Final = Kept(Worst, "measured")
