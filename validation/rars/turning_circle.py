"""The smallest circle that a Davis steering turns on, within the bounds of [R] App. C.

To be smallest: R = a / 2 + w (h^2 + b^2 - b x) / (h x), b = h a / (2 w), over the rack's travel x, the
kingpins' distance a, Davis's height h and the wheelbase w, with x < a / 2 - b - 20 mm and
h^2 + (a / 2)^2 < (100 mm)^2.
Ours is the robot's own steering at the corner of the bounds; the independent way is a search over all four.
"""

import math
from typing import Final

import numpy as np

from firmware_bridge.motion import davis
from firmware_bridge.motion.tables import DavisBase
from firmware_bridge.robot_types import find
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot

LEAST_H, LONGEST = 30.0, 100.0
"""mm: the lowest Davis height, and the length that half a trapezium may have."""
CLEARANCE: Final = 20.0
"""mm between rack's end and kingpin."""
WHEELBASES: Final = (500.0, 515.0, 600.0)
"""mm: least, built and largest."""
LARGEST_A: Final = 2.0 * math.sqrt(LONGEST**2 - LEAST_H**2)
"""mm, 190.79: at the least Davis height."""
PRINT: Final = (
    "the print's optimum (w 515, a 190, x 69.8) keeps the wheelbase at 515 mm, where 500 is within its "
    "bounds, and is cut off: a = 190 with x = 69.8 breaks its first bound by 0.33 mm"
)


def turning_circle(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    free, held = (_search(wheelbase, 8 if quick else 12) for wheelbase in ((500.0, 600.0), (515.0, 515.0)))
    # From where some travel is left.
    kingpins = np.linspace(80.0, LARGEST_A, 60)
    corner = _base(500.0, LARGEST_A)
    steered = davis.steer_from_rack(corner, _travel(500.0, LARGEST_A) / 1e3)
    return Findings(
        compared=(
            Compared("smallest radius", "mm", 228.0, free[0], _built(500.0, LARGEST_A), 0.05, PRINT),
            Compared(
                "the same with the built wheelbase, 515 mm",
                "mm",
                228.0,
                held[0],
                _built(515.0, LARGEST_A),
                0.05,
                "printed cut off",
            ),
            Compared("distance of the kingpins", "mm", 190.0, free[2], LARGEST_A, 0.05, "printed cut off"),
            Compared(
                "travel of the rack to one side", "mm", 69.8, free[1], _travel(500.0, LARGEST_A), 0.05, PRINT
            ),
            Compared(
                "angle of the inner wheel there",
                "°",
                None,
                math.degrees(math.atan(500.0 / (free[0] - free[2] / 2.0))),
                math.degrees(steered),
                0.05,
                "the source bounds no angle; its robot steers to 60°",
            ),
        ),
        plots=(
            Plot(
                "Radius over the kingpins' distance",
                "distance of the kingpins [mm]",
                "radius of the rear axle's middle [mm]",
                (
                    *(
                        Curve(f"wheelbase {wheelbase:.0f} mm", kingpins, _radii(wheelbase, kingpins))
                        for wheelbase in WHEELBASES
                    ),
                    Curve("optimum: 500 mm, 190.8 mm", [LARGEST_A], [free[0]], "points"),
                ),
                "Davis height 30 mm, the rack at its end. The radius falls with the kingpins' distance and "
                "the travel and grows with wheelbase and height: the optimum is a corner of the bounds. The "
                "robot as built has 210 mm, beyond them, and turns on 415 mm: its supports stop the wheels "
                "at 59°.",
            ),
        ),
        remarks=("What App. C minimizes is written out in the module's first lines; lengths are in mm.",),
    )


def _radius(x: Floats, a: Floats, h: Floats, w: Floats) -> Floats:
    b = h * a / (2.0 * w)
    radius: Floats = a / 2.0 + w * (h * h + b * b - b * x) / (h * x)
    allowed = (x < a / 2.0 - b - CLEARANCE) & (h * h + (a / 2.0) ** 2 < LONGEST**2) & (x > 0.0)
    return np.where(allowed, radius, np.inf)


def _search(wheelbase: tuple[float, float], points: int) -> tuple[float, float, float]:
    """Return the smallest radius, the rack's travel and the kingpins' distance: a grid that closes in."""
    low = np.array([1.0, 50.0, LEAST_H, wheelbase[0]])
    high = np.array([140.0, 270.0, 200.0, wheelbase[1]])
    begin, end, best = low.copy(), high.copy(), (math.inf, 0.0, 0.0)
    for _ in range(60):
        axes = [np.linspace(*ends, points) for ends in zip(begin, end, strict=True)]
        x, a, h, w = np.meshgrid(*axes, indexing="ij")
        radii = _radius(x, a, h, w)
        place = np.unravel_index(int(np.argmin(radii)), radii.shape)
        best = min(best, (float(radii[place]), float(x[place]), float(a[place])))
        centre = np.array([one[place] for one in (x, a, h, w)])
        half = 0.4 * (end - begin)
        begin, end = np.maximum(centre - half, low), np.minimum(centre + half, high)
    return best


def _travel(wheelbase: float, kingpins: float) -> float:
    """Return the rack's travel in mm that is left at the least Davis height."""
    return kingpins / 2.0 - LEAST_H * kingpins / (2.0 * wheelbase) - CLEARANCE


def _base(wheelbase: float, kingpins: float) -> DavisBase:
    base: DavisBase = find("rars").geometry.base
    changed = {
        "wheelbase_m": wheelbase / 1e3,
        "kingpin_distance_m": kingpins / 1e3,
        "davis_h_m": LEAST_H / 1e3,
    }
    return base.model_copy(update=changed)


def _built(wheelbase: float, kingpins: float) -> float:
    """Return the radius in mm by the robot's own steering, the rack at its end."""
    base = _base(wheelbase, kingpins)
    return 1e3 * davis.turn_radius(base, davis.steer_from_rack(base, _travel(wheelbase, kingpins) / 1e3))


def _radii(wheelbase: float, kingpins: Floats) -> list[float]:
    return [_built(wheelbase, float(one)) for one in kingpins]
