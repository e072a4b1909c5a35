"""A path follower over a slow link, through the whole chain: station, link, bridge, bus, drives, plant."""

from dataclasses import dataclass
from typing import Any, Final

import numpy as np
import pytest

from emulators.bench import mission as missions
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Floats
from emulators.bench.piloted import PilotedMission
from emulators.bench.radial_error import radial_error
from emulators.rig import Rig
from firmware_bridge.pilot.driver import DriveCommand, Driver, Sight
from firmware_bridge.pilot.link import PilotLink
from firmware_bridge.pilot.pursuit import critical_delay_s
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.robot_types import find
from firmware_bridge.units import Nanoseconds, from_seconds, to_seconds

ROBOT: Final = find("rars")
BENCH_SETUP: Final = bench_setup_of(ROBOT)
HOLD_S: Final = 0.025
"""A command that is held for 50 ms acts as one that is late by half of that."""
SWING_S: Final = 2.9
"""2 pi / (n sqrt(2 + 2 sqrt 2)), n = 1 1/s: one swing at the critical delay."""


class Watched:
    """A driver with its commands and the headings seen, each time that it sent a command."""

    def __init__(self, driver: Driver) -> None:
        self._driver = driver
        self._heading = 0.0
        self.rows: list[tuple[float, float, float]] = []

    def sees(self, sight: Sight) -> None:
        self._heading = sight.moving.pose.heading_rad
        self._driver.sees(sight)

    def command(self, link: PilotLink, now: Nanoseconds, *, armed: bool) -> DriveCommand:
        command = self._driver.command(link, now, armed=armed)
        self.rows.append((to_seconds(now), getattr(command, "yaw_rate_rad_s", 0.0), self._heading))
        return command


@dataclass(frozen=True)
class Driven:
    """Result of a run."""

    swings: tuple[float, ...]
    """Half of peak to peak of the distance to the path in each swing's time since it drove, m, by the plant;
    without its drift, which is the odometry's."""
    lag_s: float
    """Delay from a command to its visible effect on the heading."""
    radial_error_m: float | None
    station: PilotStation
    error_m: float | None
    interlock_events: tuple[str, ...]


def drive(seconds: float, link: str, max_delay_s: float | None = None, **pilot: Any) -> Driven:
    script = missions.find("pursuit", ROBOT, BENCH_SETUP).over(link, max_delay_s)
    assert script.pilot is not None
    row = script.pilot.model_copy(update=pilot)
    robot = script.on(ROBOT)
    operator = PilotedMission(robot, script.step, row)
    watched = Watched(operator.follower)
    station = PilotStation(watched, (robot.operator.system_id, robot.operator.component_id))
    operator.station = station  # type: ignore[misc] # with someone who looks over the driver's shoulder
    rig = Rig(robot, BENCH_SETUP, operator, link=script.conditions)
    try:
        rig.run(from_seconds(seconds))
    finally:
        rig.finish()
    at, samples = rig.samples.seconds, rig.samples
    began = at[np.flatnonzero(np.abs(samples.column("speed_mps")) > 0.01)[0]]
    away = 5.0 - np.hypot(samples.column("x_m"), samples.column("y_m") - (5.0 - row.offset_m))
    begins = np.arange(began, seconds - SWING_S, SWING_S)
    swings = [_bent(away[(at >= begin) & (at < begin + SWING_S)]) for begin in begins]
    predictor = operator.follower.predictor
    return Driven(
        tuple(swings),
        _lag(np.array(watched.rows), began),
        radial_error(samples, row.placed, 10.0),
        station,
        None if predictor is None else predictor.error_m,
        tuple(event.name for event in rig.interlock_events),
    )


def _bent(part: Floats) -> float:
    places = np.arange(part.size)
    return float(np.ptp(part - np.polyval(np.polyfit(places, part, 1), places))) / 2.0


def _lag(rows: Floats, began: float) -> float:
    """Return the lag of the seen heading behind the commanded yaw rate, summed up."""
    at, stated, seen = rows.T
    part = (at > began + 2.0) & (at < began + 9.0)
    grid = np.arange(0.0, at[-1], 0.005)
    held = stated[np.clip(np.searchsorted(at, grid, side="right") - 1, 0, len(at) - 1)]
    summed = np.concatenate([[0.0], np.cumsum(held[:-1] * 0.005)])
    residues = []
    for lag in np.arange(0.0, 1.2, 0.005):
        apart = np.interp(at[part] - lag, grid, summed) - np.unwrap(seen)[part]
        straight = np.polyval(np.polyfit(at[part], apart, 1), at[part])
        residues.append((float(((apart - straight) ** 2).mean()), float(lag)))
    return min(residues)[1]


def test_the_station_drives_over_the_link_and_both_sides_find_out_how_slow_it_is() -> None:
    driven = drive(11.0, "up.delay=0.25,down.delay=0.15")
    values = driven.station.shown.values
    assert driven.swings[0] > 0.0
    assert values["RTT"] == pytest.approx(0.4, abs=0.01)
    assert values["AGE"] == pytest.approx(0.2, abs=0.06)
    assert driven.station.link.round_trip(from_seconds(11.0)) == pytest.approx(from_seconds(0.4), abs=1e7)
    assert "command stale" not in driven.interlock_events


@pytest.mark.long(beside="test_a_point_that_follows_a_line_late_settles_below_it_and_swings_above")
@pytest.mark.parametrize(
    ("delay_s", "share", "settles"), [(0.40, 0.9, True), (0.50, 1.1, False)], ids=["below", "above"]
)
def test_from_10_mm_it_settles_below_the_critical_delay_and_swings_above(
    delay_s: float, share: float, *, settles: bool
) -> None:
    driven = drive(40.0, f"delay={delay_s}")
    assert (driven.lag_s + HOLD_S) / critical_delay_s(0.5, 0.5) == pytest.approx(share, abs=0.04)
    if settles:
        assert max(driven.swings[-3:]) < 0.001
    else:
        growing = driven.swings[1:5]
        assert list(growing) == sorted(growing)
        assert growing[-1] > 2.0 * growing[0]
        assert max(driven.swings[-3:]) > 0.05


@pytest.mark.long(beside="test_with_the_right_model_it_states_where_the_robot_will_be")
@pytest.mark.parametrize(
    ("link", "max_delay_s", "reaction_s"),
    [
        ("delay=0.8", None, 0.0),
        ("delay=0.8", None, 0.1),
        ("up.delay=0.4,down.delay=0.4,jitter=0.05,loss=0.02,duplicate=0.02", 0.8, 0.0),
    ],
    ids=["0.8 s", "0.1 s that it does not know of", "a bad link"],
)
def test_with_the_predictor_it_does_not_swing(
    link: str, max_delay_s: float | None, reaction_s: float
) -> None:
    driven = drive(40.0, link, max_delay_s, predictor=True, reaction_s=reaction_s)
    assert max(driven.swings[-3:]) < 0.001
    assert driven.radial_error_m is not None
    assert driven.radial_error_m < 0.01
    assert driven.error_m is not None
    assert driven.error_m < 0.01
