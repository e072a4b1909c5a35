"""The climber's path on its tank: unrolled, by plant and bridge, and in space."""

from typing import TYPE_CHECKING, Final

import numpy as np

from emulators.bench.columns import Floats, Samples
from emulators.bench.style import BLUE, GREEN, INK, PALE
from firmware_bridge.robot import Robot
from firmware_bridge.robots.climber.geometry import ClimberGeometry

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MARGIN_M: Final = 0.5
"""Margin of the tank drawn around the path."""
LINES: Final = 9
TICKS: Final = 5


def on_the_tank(figure: "Figure", robot: Robot[ClimberGeometry], samples: Samples) -> None:
    """Draw the path of the plant and the bridge's estimate, on the unrolled tank and in space."""
    figure.set_size_inches(11.0, 5.6)
    radius = robot.geometry.tank.radius_m
    arc, height = samples.column("x_m"), samples.column("y_m")
    flat = figure.add_subplot(1, 2, 1)
    flat.plot(arc, height, color=BLUE, linewidth=3.2, alpha=0.45, label="actual (plant)")
    estimated = samples.column("odometry_x_m"), samples.column("odometry_y_m")
    flat.plot(*estimated, color=INK, linewidth=0.7, label="estimated by the bridge")
    flat.scatter(arc[:1], height[:1], s=54, facecolor="white", edgecolor=GREEN, zorder=5, label="start")
    flat.set(title="Path, tank unrolled", xlabel="arc around the tank [m]", ylabel="height [m]")
    flat.set_aspect("equal", adjustable="datalim")
    flat.legend(loc="best")
    space = figure.add_subplot(1, 2, 2, projection="3d")
    rows = np.linspace(height.min() - MARGIN_M, height.max() + MARGIN_M, LINES)
    columns = np.linspace(arc.min() - MARGIN_M, arc.max() + MARGIN_M, LINES)
    wall = _in_space(*np.meshgrid(columns, rows), radius)
    space.plot_wireframe(*wall, color=PALE, linewidth=0.4)
    space.plot(*_in_space(arc, height, radius), color=BLUE, linewidth=2.0)
    space.set(title="Path of the plant on the tank", ylabel="tangential [m]", zlabel="height [m]")
    # The radial direction spans a few centimeters: its numbers would lie on one another.
    space.set_xticks([])
    space.locator_params(axis="y", nbins=TICKS)
    space.locator_params(axis="z", nbins=TICKS)
    space.yaxis.labelpad = space.zaxis.labelpad = 10.0
    space.set_aspect("equal")
    space.set_box_aspect(None, zoom=0.85)


def _in_space(arc: Floats, height: Floats, radius: float) -> tuple[Floats, Floats, Floats]:
    """Return the places in space of points of the unrolled tank, from the start of the path."""
    return radius * (np.cos(arc / radius) - 1.0), radius * np.sin(arc / radius), height
