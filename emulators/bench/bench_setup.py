"""A robot's part of the bench: the inputs of a mission's step, the station's messages, and the figures.

A mission's input is one field of the robot's step: its annotation gives the action on the controls. A figure
is one column, which may be drawn in a panel and listed in the summary.
"""

from collections.abc import Callable, Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import EntryPoint, EntryPoints, entry_points
from pathlib import Path as FilePath
from typing import TYPE_CHECKING, Any, Final

from emulators.bench.cases import Case
from emulators.bench.columns import Column, Panel, Samples
from emulators.bench.path_error import Path
from emulators.bench.step import Step
from firmware_bridge import renamed
from firmware_bridge.robot import AnyRobot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

GROUP: Final = "firmware_bridge.bench_setups"
OLD_GROUP: Final = "firmware_bridge.rehearsals"
"""Its name of the release before."""


@dataclass(frozen=True, slots=True)
class Channel:
    """One thing that the operator's hand holds until a later step, by stick or as a twist; SI."""

    name: str
    full: Callable[[AnyRobot], float]
    """Its value at full stick."""
    trembles_with: str = ""
    """The channel with which the hand's tremor comes and goes: a foot off the pedal does not tremble."""
    stick_only: bool = False


@dataclass(frozen=True, slots=True)
class StickAxes:
    """MANUAL_CONTROL's axes as shares of full stick, -1 to 1, with MAVLink's signs; None for no use."""

    x: float | None = None
    y: float | None = None
    z: float | None = None
    r: float | None = None
    buttons: int = 0
    """The buttons that must be down for this."""


@dataclass(frozen=True, slots=True)
class TwistAxes:
    """SET_POSITION_TARGET_LOCAL_NED's velocities with MAVLink's signs: forward, right, clockwise; SI."""

    vx: float
    vy: float = 0.0
    yaw_rate: float = 0.0


@renamed.arguments(stands="start_positions")
@dataclass(frozen=True, slots=True)
class BenchSetup:
    """One robot on the bench."""

    step: type[Step]
    missions: FilePath
    """The folder of its shipped missions."""
    channels: tuple[Channel, ...]
    stick: Callable[[Mapping[str, float], AnyRobot], StickAxes]
    """Return what a station sends for these values of the channels; signs and scales are its own."""
    twist: Callable[[Mapping[str, float], AnyRobot], TwistAxes]
    columns: tuple[Column, ...]
    """Its own, beside those of `emulators.bench.columns.columns_of`; the planar ones are needed."""
    panels: tuple[Panel, ...]
    remarks: Callable[[AnyRobot], Mapping[str, str]]
    """Remarks beside the summary's numbers, by their keys: the robot's limits."""
    cases: Callable[[AnyRobot], Iterable[Case[Any, Any]]]
    """Boundary cases, one at least for each of its kind's interlocks and limits."""
    start_positions: Mapping[str, float] = field(default_factory=dict)
    """Initial positions of the plant, by the axes' roles and as read off the robot; 0 where none is given."""
    well: Mapping[str, float] = field(default_factory=dict)
    """Sensor values, by their names, of a robot that is well, where it does not move without."""
    figures_by_file: Mapping[str, Callable[[Samples, AnyRobot], float | None]] = field(default_factory=dict)
    """Further numbers of the summary, for which the robot file is needed."""
    figures: Mapping[str, Callable[[Samples], float | None]] = field(default_factory=dict)
    """Its own numbers in the summary, by their keys there; None where a run has no such number."""
    pictures: Mapping[str, Callable[["Figure", AnyRobot, Samples], None]] = field(default_factory=dict)
    """Its own pictures of a run, by their files' names."""
    paths: Mapping[str, Callable[[AnyRobot], Path]] = field(default_factory=dict)
    """Reference positions of path followers that go by the clock, by name.

    They need the column `OFFSET` of `emulators.bench.path_error`.
    """

    @property
    def stands(self) -> Mapping[str, float]:
        """The old name of `start_positions`."""
        renamed.warn("stands", "start_positions", "BenchSetup")
        return self.start_positions

    def shipped(self) -> dict[str, FilePath]:
        """Return the shipped missions by their names, in alphabetical order."""
        return {path.stem: path for path in sorted(self.missions.glob("*.toml"))}


@cache
def _entries() -> EntryPoints:
    new, old = entry_points(group=GROUP), entry_points(group=OLD_GROUP)
    # A package with both names counts once, under the new one.
    alone = [entry for entry in old if entry.name not in new.names]
    for entry in alone:
        renamed.warn(OLD_GROUP, GROUP, f"entry point {entry.name}")
    return EntryPoints((*new, *alone))


def bench_setups() -> dict[str, BenchSetup]:
    """Return every installed robot's bench setup by its kind, in the order of the kinds' names.

    One that cannot be loaded is excluded: `bench_setup_of` gives the reason.
    """
    found: dict[str, BenchSetup] = {}
    for entry in sorted(_entries(), key=lambda entry: entry.name):
        with suppress(LookupError):
            found[entry.name] = _loaded(entry)
    return found


def mission_names() -> list[str]:
    """Return the names of all shipped missions, of whichever robot."""
    return sorted({name for bench_setup in bench_setups().values() for name in bench_setup.shipped()})


def bench_setup_of(robot: AnyRobot) -> BenchSetup:
    """Return the bench setup of a robot's kind; LookupError where its package brings none."""
    for entry in _entries().select(name=robot.kind):
        return _loaded(entry)
    raise LookupError(f"the package of the robot '{robot.kind}' brings no bench setup (entry point {GROUP})")


def _loaded(entry: EntryPoint) -> BenchSetup:
    try:
        bench_setup: BenchSetup = entry.load()
    except Exception as error:
        # Any error of another's package: the other robots must still be usable.
        why = f"{type(error).__name__}: {error} ({entry.value})"
        raise LookupError(f"the bench setup of '{entry.name}' cannot be loaded: {why}") from error
    return bench_setup
