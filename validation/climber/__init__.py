"""The climber's studies: the cases of its paper, made again beside an independent solution.

Qualls, Canfield, Shibakov, "Kinematic control of a mobile robot performing manufacturing tasks on non-planar
surfaces", JAMRIS 10(3), 2016. Its radii of 2e5, 2e2 and 0.5e2 "m" do not fit its ratios: the ratios count.
"""

from typing import Final

from validation.studies.study import Study

PAPER: Final = "Qualls, Canfield, Shibakov, JAMRIS 10(3), 2016"
HERE: Final = "validation.climber"

STUDIES: Final = (
    Study(
        "curvature",
        "A circle by the wheels' speeds: how far it is from closing, over the tank's radius",
        f"{PAPER}, 4, Fig. 4",
        f"{HERE}.curvature:curvature",
    ),
    Study(
        "chassis_speeds",
        "The chassis's speed and turn rate held, open loop: four maneuvers; circles over the tank's radius",
        f"{PAPER}, cases 1 and 2, Fig. 7, 8",
        f"{HERE}.chassis_speeds:chassis_speeds",
    ),
    Study(
        "equal_speeds",
        "Equal speeds do not keep it straight: ratio 20, and the laboratory's tank",
        f"{PAPER}, 4, Fig. 6",
        f"{HERE}.equal_speeds:equal_speeds",
    ),
    Study(
        "three_ways",
        "Three ways on one unrolled picture: planar, exact rolling, the plant; and the chains closed by (30)",
        f"{PAPER}, (1)-(3), (30), Fig. 6",
        f"{HERE}.three_ways:three_ways",
    ),
    Study(
        "pivot",
        "It turns about one wheel: the reduced solution, as printed and corrected",
        f"{PAPER}, (33)",
        f"{HERE}.pivot:pivot",
    ),
    Study(
        "polar_law",
        "The polar law, as printed and corrected, to poses all round",
        f"{PAPER}, (27)-(29)",
        f"{HERE}.polar_law:polar_law",
    ),
    Study(
        "closed_loops",
        "Triangle, square and diamond through the whole chain",
        f"{PAPER}, 5",
        f"{HERE}.closed_loops:closed_loops",
    ),
)
