"""One run in numbers: what the plant did, the bridge believed and the bus carried, and active interlocks."""

import json
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from types import MappingProxyType
from typing import Any, Final, TypeVar

import numpy as np
from numpy.typing import NDArray

from emulators.bench.columns import ODOMETRY, POSE, SAMPLE_EVERY, SIDEWAYS, Floats, Samples, current
from emulators.bench.path_error import PathError
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.family import LineRun
from firmware_bridge import renamed
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

_Number = TypeVar("_Number", np.float64, np.complex128)
NO_PATH: Final = PathError()
NO_FIGURES: Final[Mapping[str, Callable[[Samples], float | None]]] = MappingProxyType({})
USUAL_CYCLE: Final[Nanoseconds] = 50 * MILLISECOND


@dataclass(frozen=True, slots=True)
class RunFigures:
    """Settings of a run, and the figures of its wires and clocks."""

    robot: str
    mission: str
    seed: int
    simulated: Nanoseconds
    wall_s: float
    frames: int
    bus_load_percent: float
    trace_sha256: str
    links_sha256: dict[str, str]
    guard_refusals: int = 0
    lines: tuple[LineRun, ...] = ()
    cycle: Nanoseconds = USUAL_CYCLE
    """Of the set-points."""


@dataclass(frozen=True, slots=True)
class InterlockEntry:
    """One hold, in seconds from the start of the run."""

    name: str
    reason: str
    began_s: float
    ended_s: float | None
    remedy: str = ""
    """Remedy for the operator."""


@dataclass(frozen=True, slots=True)
class Faulted:
    """One fault that was put on, in seconds from the start of the run."""

    kind: str
    title: str
    nodes: tuple[str, ...]
    began_s: float
    ended_s: float | None


@dataclass(frozen=True, slots=True)
class Summary:
    """Contents of `summary.json`; the names of the fields are its keys."""

    robot: str
    mission: str
    seed: int
    simulated_s: float
    wall_s: float
    realtime_factor: float
    max_speed_mps: float
    """Forward; of a robot that moves sideways, too, in whichever direction."""
    max_acceleration_mps2: float
    """Largest change of the same over a cycle of the set-points, emergency stops included."""
    max_lateral_acceleration_mps2: float
    """Largest speed times yaw rate."""
    path_length_m: float
    odometry_error_m: float
    """Distance between the bridge's pose and the plant's at the end of the run."""
    max_odometry_error_m: float
    """The largest such distance; while the robot moves it holds up to one cycle's travel of pure delay."""
    max_path_error_m: float | None
    """The largest distance from the followed path at the same instant, once settled; None without a path."""
    max_cross_track_m: float | None
    """The same across the path."""
    radial_error_m: float | None
    """Half of peak to peak of a pilot's distance from its path by the plant's truth, once it had settled: of
    a circle, of the radius. None where no pilot drove."""
    max_current_a: float
    largest: dict[str, float]
    """Largest absolute values of the robot's columns with `most`, in the column's unit."""
    frames: int
    bus_load_percent: float
    trace_sha256: str
    """Hash of every packet on every link."""
    links_sha256: dict[str, str]
    """Hash of each link alone, by its name: it shows which one a change has reached."""
    guard_refusals: int
    """Packets of the bridge that the guard let nothing of through, and silences that it filled."""
    interlock_events: tuple[InterlockEntry, ...]
    faults: tuple[Faulted, ...] = ()
    lines: tuple[LineRun, ...] = ()
    """The serial lines between bridge and drives; none where the bridge is on the CAN bus itself."""
    acceleration_is: str = "forward, over 50 ms"
    """Direction and time over which the acceleration is the mean."""
    figures: dict[str, float | None] = field(default_factory=dict)
    """The robot's own numbers; in the file each is a key like the others."""

    @property
    def holds(self) -> tuple[InterlockEntry, ...]:
        """The interlock events, with the names of the release before."""
        renamed.warn("holds", "interlock_events", "Summary")
        return self.as_before()

    def as_before(self) -> tuple[InterlockEntry, ...]:
        """Return the interlock events under their names of the release before."""
        return tuple(replace(one, name=renamed.old_interlock(one.name)) for one in self.interlock_events)


def summarize(
    run: RunFigures,
    axes: Sequence[str],
    samples: Samples,
    holds: Sequence[InterlockEvent],
    faults: Sequence[FaultRecord] = (),
    *,
    path: PathError = NO_PATH,
    radial_error_m: float | None = None,
    figures: Mapping[str, Callable[[Samples], float | None]] = NO_FIGURES,
) -> Summary:
    """Turn a run's rows into its numbers; a run without rows has not moved."""
    speed = samples.column("speed_mps")
    velocity = over_floor(samples) if samples.has(SIDEWAYS) else speed
    direction = "in all directions" if samples.has(SIDEWAYS) else "forward"
    lateral = speed * samples.column("yaw_rate_rad_s")
    steps = np.hypot(np.diff(samples.column("x_m")), np.diff(samples.column("y_m")))
    errors = odometry_errors(samples)
    # A robot on steppers has no motor current: then the maximum is that of one zero.
    currents = np.concatenate([samples.column(current(axis)) for axis in axes] or [np.zeros(1)])
    simulated_s = to_seconds(run.simulated)
    return Summary(
        robot=run.robot,
        mission=run.mission,
        seed=run.seed,
        simulated_s=simulated_s,
        wall_s=round(run.wall_s, 3),
        realtime_factor=round(simulated_s / run.wall_s, 2) if run.wall_s > 0.0 else 0.0,
        max_speed_mps=_largest(velocity),
        max_acceleration_mps2=_largest(mean_acceleration(velocity, run.cycle)),
        max_lateral_acceleration_mps2=_largest(lateral),
        path_length_m=float(steps.sum()),
        odometry_error_m=float(errors[-1]) if errors.size else 0.0,
        max_odometry_error_m=_largest(errors),
        max_path_error_m=path.same_instant,
        max_cross_track_m=path.across,
        radial_error_m=radial_error_m,
        max_current_a=_largest(currents),
        largest={
            column.name: _largest(samples.column(column.name)) for column in samples.columns if column.most
        },
        frames=run.frames,
        bus_load_percent=round(run.bus_load_percent, 3),
        trace_sha256=run.trace_sha256,
        links_sha256=run.links_sha256,
        guard_refusals=run.guard_refusals,
        interlock_events=tuple(map(entry_of, holds)),
        faults=tuple(Faulted(fault.kind, fault.title, fault.nodes, *_span(fault)) for fault in faults),
        lines=run.lines,
        acceleration_is=f"{direction}, over {averaged_over(run.cycle) // MILLISECOND} ms",
        figures={name: figure(samples) for name, figure in figures.items()},
    )


def entry_of(hold: InterlockEvent) -> InterlockEntry:
    """Return an interlock event as it stands in a summary."""
    return InterlockEntry(hold.name, hold.reason, *_span(hold), hold.remedy)


def over_floor(samples: Samples) -> NDArray[np.complex128]:
    """Return the velocity in m/s in the frame in which the run began, as complex numbers."""
    own = samples.column("speed_mps") + 1j * samples.column(SIDEWAYS)
    velocity: NDArray[np.complex128] = own * np.exp(1j * samples.column(POSE[2]))
    return velocity


def mean_acceleration(velocity: NDArray[_Number], cycle: Nanoseconds = USUAL_CYCLE) -> NDArray[_Number]:
    """Return the acceleration in m/s2, averaged over each window of one cycle of rows 10 ms apart."""
    window = averaged_over(cycle)
    rows = window // SAMPLE_EVERY
    change: NDArray[_Number] = (velocity[rows:] - velocity[:-rows]) / to_seconds(window)
    return change


def averaged_over(cycle: Nanoseconds) -> Nanoseconds:
    """Return the time over which acceleration is averaged: a cycle of the set-points, in whole rows.

    At least 50 ms: a motor's ripple does not move the platform.
    """
    return max(cycle // SAMPLE_EVERY * SAMPLE_EVERY, USUAL_CYCLE)


def odometry_errors(samples: Samples) -> Floats:
    """Return the distance in meters between the bridge's pose and the plant's, row by row.

    The bridge counts from where it began, the plant from its own origin: the first row in which it believes
    anything makes them agree. Rows without an estimate are left out.
    """
    believes = np.isfinite(samples.column(ODOMETRY[0]))
    if not believes.any():
        return np.array([], dtype=np.float64)
    (x, y, heading), (ox, oy, odometry_heading) = (
        [samples.column(name)[believes] for name in names] for names in (POSE, ODOMETRY)
    )
    # Joined in the first row with a pose: an offset of the two frames is no error of the odometry.
    turn = heading[0] - odometry_heading[0]
    believed = (ox - ox[0]) + 1j * (oy - oy[0])
    true = (x - x[0]) + 1j * (y - y[0])
    apart: Floats = np.abs(true - believed * np.exp(1j * turn))
    return apart


def as_json(summary: Summary) -> str:
    """Write a summary as JSON, one key a line, ending in a new line.

    `holds` has the interlock events under their names of the release before, for one release more.
    """
    table = asdict(summary)
    # The key of the release before, for readers that have not changed.
    table["holds"] = [asdict(one) for one in summary.as_before()]
    return json.dumps(table | table.pop("figures"), indent=2, ensure_ascii=False) + "\n"


def _span(record: InterlockEvent | FaultRecord) -> tuple[float, float | None]:
    return to_seconds(record.began), None if record.ended is None else to_seconds(record.ended)


def _largest(values: NDArray[Any]) -> float:
    return float(np.abs(values).max()) if values.size else 0.0


__getattr__ = renamed.module(__name__, __name__, Held="InterlockEntry", Run="RunFigures")
