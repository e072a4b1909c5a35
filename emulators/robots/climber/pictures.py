"""The climber's way on its tank: unrolled, as the bridge counts it, and in space."""

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


def on_the_tank(figure: "Figure", robot: Robot[ClimberGeometry], samples: Samples) -> None:
    """Draw the way of the plant and what the bridge believed, on the unrolled tank and in space."""
    figure.set_size_inches(11.0, 5.6)
    radius = robot.geometry.tank.radius_m
    arc, height = samples.column("x_m"), samples.column("y_m")
    flat = figure.add_subplot(1, 2, 1)
    flat.plot(arc, height, color=BLUE, linewidth=3.2, alpha=0.45, label="plant")
    believed = samples.column("odometry_x_m"), samples.column("odometry_y_m")
    flat.plot(*believed, color=INK, linewidth=0.7, label="bridge")
    flat.scatter(arc[:1], height[:1], s=54, facecolor="white", edgecolor=GREEN, zorder=5, label="start")
    flat.set(title="Unrolled", xlabel="way round the tank [m]", ylabel="height [m]")
    flat.set_aspect("equal", adjustable="datalim")
    flat.legend(loc="best")
    space = figure.add_subplot(1, 2, 2, projection="3d")
    rows = np.linspace(height.min() - MARGIN_M, height.max() + MARGIN_M, LINES)
    columns = np.linspace(arc.min() - MARGIN_M, arc.max() + MARGIN_M, LINES)
    wall = _in_space(*np.meshgrid(columns, rows), radius)
    space.plot_wireframe(*wall, color=PALE, linewidth=0.4)
    space.plot(*_in_space(arc, height, radius), color=BLUE, linewidth=2.0)
    space.set(title="On the tank", xlabel="out [m]", ylabel="round [m]", zlabel="height [m]")
    space.set_xticks([])
    space.set_aspect("equal")


def _in_space(arc: Floats, height: Floats, radius: float) -> tuple[Floats, Floats, Floats]:
    """Return where places of the unrolled tank are, from where the way begins on it."""
    return radius * (np.cos(arc / radius) - 1.0), radius * np.sin(arc / radius), height
