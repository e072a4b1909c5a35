"""A picture of a run: one unit on an axis, a name at each band, an envelope in place of a solid block."""

import re
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from emulators.bench import plots
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.columns import Column, Curve, Floats, Panel, Samples, columns_of
from emulators.bench.envelope import draw_curve, envelope
from emulators.bench.path_picture import path_picture
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.bench.time_pictures import currents_picture, interlocks_picture, panels_picture
from firmware_bridge.robot_types import find, names
from firmware_bridge.units import MILLISECOND, SECOND

RARS = find("rars")
UNIT = re.compile(r"\[[^\]]+\]")
PIXELS = 1080.0
SECONDS = np.arange(10_000) / 1000.0
"""10 s, every millisecond: 18 samples in a bin of two pixels."""


def samples_of(robot_name: str, count: int = 50) -> Samples:
    robot = find(robot_name)
    table = Samples(columns_of([axis.name for axis in robot.axes], bench_setup_of(robot).columns))
    for index in range(count):
        table.add(index * 10 * MILLISECOND, tuple(0.1 * index + place for place in range(len(table.columns))))
    return table


def drawn(robot_name: str, panels: Sequence[Panel] | None = None) -> Figure:
    robot, figure = find(robot_name), Figure()
    shown = bench_setup_of(robot).panels if panels is None else panels
    panels_picture(figure, robot, shown, samples_of(robot_name), [])
    return figure


def noise() -> Floats:
    return np.random.default_rng(0).uniform(-1.0, 1.0, len(SECONDS))


@pytest.mark.parametrize("name", names())
def test_each_axis_of_a_panel_has_curves_of_one_unit_only(name: str) -> None:
    setup = bench_setup_of(find(name))
    columns = {column.name: column for column in setup.columns}
    for panel in setup.panels:
        for right in (False, True):
            curves = [curve for curve in panel.curves if curve.right is right]
            assert len({(columns[curve.column].unit, curve.scale) for curve in curves}) <= 1, panel.title
        assert bool(panel.right) is any(curve.right for curve in panel.curves)


@pytest.mark.parametrize("name", names())
def test_each_vertical_axis_is_labeled_with_one_unit(name: str) -> None:
    for axes in drawn(name).axes:
        assert len(UNIT.findall(axes.get_ylabel())) == 1, axes.get_ylabel()


@pytest.mark.parametrize("name", names())
def test_no_two_curves_of_an_axis_have_one_color(name: str) -> None:
    for axes in drawn(name).axes:
        colors = [line.get_color() for line in axes.get_lines() if not str(line.get_label()).startswith("_")]
        assert len(set(colors)) == len(colors), axes.get_title(loc="left") or axes.get_ylabel()


@pytest.mark.parametrize("name", names())
def test_set_points_and_actual_values_are_named_by_the_terms_of_the_field(name: str) -> None:
    for panel in bench_setup_of(find(name)).panels:
        for curve in panel.curves:
            assert curve.label.startswith("set-point") is curve.step
            assert "demanded" not in curve.label
            assert curve.label != "plant"


def test_a_second_quantity_has_an_axis_of_its_own_and_each_curve_names_its_axis() -> None:
    _speed, steering, _lift, right = drawn("rars").axes
    assert (steering.get_ylabel(), right.get_ylabel()) == ("angle [deg]", "yaw rate [deg/s]")
    assert right.yaxis.get_ticks_position() == "right"
    legend = steering.get_legend()
    assert legend is not None
    labels = [text.get_text() for text in legend.get_texts()]
    assert [label.rpartition(" (")[2] for label in labels] == ["left axis)", "right axis)"]


def test_both_axes_of_a_panel_have_their_zeros_at_one_height() -> None:
    curves = (Curve("one", "one"), Curve("other", "other", right=True))
    table = Samples((Column("one", "", "m"), Column("other", "", "s")))
    for index in range(10):
        table.add(index * SECOND, (float(index), -100.0 * index))
    figure = Figure()
    panels_picture(figure, RARS, [Panel("both", "way [m]", curves, right="time [s]")], table, [])
    shares = [-low / (high - low) for low, high in (axes.get_ylim() for axes in figure.axes)]
    assert shares[0] == pytest.approx(shares[1])
    for axes, (least, most) in zip(figure.axes, ((0.0, 9.0), (-900.0, 0.0)), strict=True):
        low, high = axes.get_ylim()
        assert low <= least
        assert most <= high


def bands(axes: Axes) -> list[tuple[float, float]]:
    """Return each collection of bars' lowest and highest place on the vertical axis."""
    found = []
    for collection in axes.collections:
        heights = np.concatenate([np.asarray(path.vertices)[:, 1] for path in collection.get_paths()])
        found.append((float(heights.min()), float(heights.max())))
    return found


def test_each_band_of_an_interlock_of_the_armed_state_and_of_a_fault_is_named_at_its_row() -> None:
    events = [
        InterlockEvent("not_armed", "the robot is not armed", 0, SECOND // 10),
        InterlockEvent("speed limit", "requested 0.8 m/s", SECOND // 10, SECOND // 5),
        InterlockEvent("not_armed", "the robot is not armed", SECOND // 3),
    ]
    faults = [FaultRecord("can_cut", "", ("left",), SECOND // 5), FaultRecord("bus_off", "", (), SECOND // 4)]
    figure = Figure()
    interlocks_picture(figure, samples_of("rars"), events, faults)
    (axes,) = figure.axes
    labels = [label.get_text() for label in axes.get_yticklabels()]
    assert labels == ["not armed", "speed limit", "state: armed", "fault: can cut", "fault: bus off"]
    rows = bands(axes)
    assert len(rows) == len(labels)
    for place, (low, high) in zip(axes.get_yticks(), rows, strict=True):
        assert low <= place <= high


def test_noise_of_1_khz_is_drawn_as_mean_and_envelope() -> None:
    found = envelope(SECONDS, noise(), PIXELS)
    assert found is not None
    assert found.bin_s == pytest.approx(0.0185, rel=0.01)
    assert len(found.seconds) == PIXELS / 2.0
    assert np.all(found.low < -0.3)
    assert np.all(found.high > 0.3)
    # The mean of 18 uniform values has a standard deviation of 0.14.
    assert np.abs(found.mean).max() < 0.6


@pytest.mark.parametrize(
    "values",
    [
        np.sin(SECONDS),
        SECONDS + 0.001 * noise(),
        np.where(SECONDS > 5.0, 1.0, 0.0),
        np.where(SECONDS == 5.0, 9.0, np.sin(SECONDS)),
        np.zeros(len(SECONDS)),
        np.full(len(SECONDS), np.nan),
        np.sin(SECONDS * 30.0),
    ],
    ids=[
        "smooth",
        "noise below a line's width",
        "step",
        "peak",
        "constant",
        "unknown",
        "periods of 22 pixels",
    ],
)
def test_what_a_line_shows_is_drawn_as_a_line(values: Floats) -> None:
    assert envelope(SECONDS, values, PIXELS) is None


def test_few_samples_are_drawn_as_a_line_whatever_they_are() -> None:
    assert envelope(SECONDS[:1000], noise()[:1000], PIXELS) is None
    assert envelope(SECONDS[:0], noise()[:0], PIXELS) is None
    assert envelope(SECONDS[:1], noise()[:1], PIXELS) is None


def test_an_envelope_has_a_gap_where_the_samples_have_one() -> None:
    values = noise()
    values[4000:6000] = np.nan
    found = envelope(SECONDS, values, PIXELS)
    assert found is not None
    unknown = np.isnan(found.mean)
    assert 0.19 < unknown.mean() < 0.21
    assert np.array_equal(unknown, np.isnan(found.low))


@pytest.mark.parametrize(("values", "filled", "label"), [(noise(), 1, "J1, mean"), (SECONDS, 0, "J1")])
def test_the_fill_of_an_envelope_is_in_the_axes_and_its_line_is_named_mean(
    values: Floats, filled: int, label: str
) -> None:
    axes = Figure(figsize=(10.0, 4.0), dpi=120).add_subplot()
    draw_curve(axes, SECONDS, values, "black", "J1")
    assert len([it for it in axes.collections if isinstance(it, PolyCollection)]) == filled
    assert [line.get_label() for line in axes.get_lines()] == [label]


def test_a_motor_current_drawn_as_an_envelope_is_described_beside_its_title() -> None:
    table = Samples((Column("current_left_a", "", "A"), Column("current_lift_a", "", "A")))
    for index, value in enumerate(noise()):
        table.add(index * 10 * MILLISECOND, (float(value), 0.001 * index))
    figure = Figure(dpi=120)
    currents_picture(figure, RARS, table)
    noisy, smooth = figure.axes
    assert "line: mean, band: min to max per 0.19 s" in noisy.texts[0].get_text()
    assert "band" not in smooth.texts[0].get_text()
    assert "continuous limit 0.8 A (dotted)" in smooth.texts[0].get_text()


def test_a_fault_is_marked_once_where_a_panel_has_two_vertical_axes(tmp_path: Path) -> None:
    marked: list[int] = []

    def count(rows: Sequence[Axes], *_args: object, **_named: object) -> None:
        marked.append(len(rows))

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(plots, "mark_faults", count)
        plots.draw(tmp_path, "rars", RARS, bench_setup_of(RARS).panels, samples_of("rars"), events=[])
    assert marked == [3, 4, 1]


@pytest.mark.parametrize(
    ("name", "x", "y"),
    [
        ("rars", "x, forward at the start [m]", "y, left [m]"),
        ("ar2", "tool ahead of the foot [m]", "tool above the floor [m]"),
        (
            "climber",
            "arc around the tank, to the right of an observer who looks up [m]",
            "height along the tank's axis [m]",
        ),
    ],
)
def test_a_path_has_the_axes_of_its_robot(name: str, x: str, y: str) -> None:
    figure = Figure(layout="constrained")
    path_picture(figure, samples_of(name), [])
    (axes,) = figure.axes
    assert (axes.get_xlabel(), axes.get_ylabel()) == (x, y)
