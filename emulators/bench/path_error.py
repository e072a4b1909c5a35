"""Distance of the plant from the path of a path follower: at the same instant, and across the path.

The reference is the bench's own arithmetic. It begins at the bridge's own pose when its path follower began,
and goes on with the follower's clock, which waits while the robot is held back.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import Final, TypeAlias

import numpy as np

from emulators.bench.columns import ODOMETRY, POSE, Floats, Samples

OFFSET: Final = "path_offset_s"
"""The column of the path follower's clock less the run's, s; NaN where no path follower drives."""
AHEAD_S: Final = 1.0
"""Range along the path, to either side, in which its nearest point is looked for."""
STEPS: Final = 41

HEIGHT: Final = "height_m"
"""The column of how high is what a path with heights leads."""

Path: TypeAlias = Callable[[Floats], tuple[Floats, ...]]
"""Positions of the path by its own seconds, in m.

Ahead and left of its initial direction; and up, where it leads something up and down.
"""


@dataclass(frozen=True, slots=True)
class Followed:
    """A path that a mission has a path follower follow from an instant on, s."""

    from_s: float
    path: Path | None


@dataclass(frozen=True, slots=True)
class PathError:
    """The largest distances in m from when it had settled on; None where nothing was followed for so long."""

    same_instant: float | None = None
    across: float | None = None


def path_error(samples: Samples, followed: Sequence[Followed], settled_after_s: float) -> PathError:
    """Return how far the plant's truth was from the paths."""
    if not followed or not len(samples):
        return PathError()
    same, across = [], []
    for rows, path in _stretches(samples, followed):
        settled = rows[samples.seconds[rows] >= samples.seconds[rows[0]] + settled_after_s]
        if settled.size:
            reference = _placed(samples, rows[0], path)
            seconds = samples.seconds[settled] + samples.column(OFFSET)[settled]
            truth = _complex(samples, POSE)[settled]
            off = np.hypot(np.abs(truth - reference(seconds)), _too_high(samples, rows[0], settled, path))
            same.append(float(off.max()))
            across.append(
                max(_nearest(point, at, reference) for point, at in zip(truth, seconds, strict=True))
            )
    return PathError(max(same), max(across)) if same else PathError()


def _stretches(samples: Samples, followed: Sequence[Followed]) -> Iterator[tuple[np.ndarray, Path]]:
    """Yield the rows in which a path follower drives along one path, and the path."""
    guided = np.isfinite(samples.column(OFFSET))
    for place, one in enumerate(followed):
        until = followed[place + 1].from_s if place + 1 < len(followed) else np.inf
        within = guided & (samples.seconds >= one.from_s) & (samples.seconds < until)
        rows = np.flatnonzero(within)
        if one.path is not None and rows.size:
            yield rows, one.path


def _placed(samples: Samples, begin: int, path: Path) -> Callable[[Floats], np.ndarray]:
    """Return the path in the plant's own frame, as complex numbers."""
    believed, true = _complex(samples, ODOMETRY), _complex(samples, POSE)
    headings = [samples.column(names[2]) for names in (POSE, ODOMETRY)]
    # The first row in which the bridge has a pose joins its frame to the plant's.
    first = int(np.isfinite(believed).argmax())
    turn = headings[0][first] - headings[1][first]
    # Complex numbers: a turn of the plane is one product.
    start = true[first] + (believed[begin] - believed[first]) * np.exp(1j * turn)
    course = np.exp(1j * (turn + headings[1][begin]))
    first_x, first_y, *_ = path(np.zeros(1))

    def at(seconds: Floats) -> np.ndarray:
        x, y, *_ = path(seconds)
        placed: np.ndarray = start + (x - first_x + 1j * (y - first_y)) * course
        return placed

    return at


def _too_high(samples: Samples, begin: int, rows: np.ndarray, path: Path) -> Floats:
    """Return how much too high it was in these rows; 0 where the path has no heights."""
    first, heights = path(np.zeros(1))[2:], path(samples.seconds[rows] + samples.column(OFFSET)[rows])[2:]
    if not heights:
        return np.zeros(rows.size)
    true = samples.column(HEIGHT)
    too_high: Floats = true[rows] - true[begin] - (heights[0] - first[0])
    return too_high


def _complex(samples: Samples, names: tuple[str, str, str]) -> np.ndarray:
    joined: np.ndarray = samples.column(names[0]) + 1j * samples.column(names[1])
    return joined


def _nearest(point: complex, at: float, reference: Callable[[Floats], np.ndarray]) -> float:
    """Return the distance from a point to the path near one of its instants, chord by chord."""
    line = reference(np.linspace(at - AHEAD_S, at + AHEAD_S, STEPS))
    begin, chord = line[:-1], np.diff(line)
    length = np.abs(chord) ** 2
    # A path that waits has chords without length: 1 keeps the division defined.
    along = np.where(
        length > 0.0, ((point - begin) * chord.conj()).real / np.where(length > 0.0, length, 1.0), 0.0
    )
    # Within the chord: beyond its ends the neighboring ones are nearer.
    return float(np.abs(point - begin - np.clip(along, 0.0, 1.0) * chord).min())
