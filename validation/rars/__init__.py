"""RARS's studies: figures and numbers of its thesis, made again beside an independent way.

A. P. Das, "Design and control of a tele-operated mobile platform", PhD thesis, IIT Delhi, 2018.
"""

from typing import Final

from validation.studies.study import Study

THESIS: Final = "A. P. Das, PhD thesis, IIT Delhi, 2018"
HERE: Final = "validation.rars"

STUDIES: Final = (
    Study(
        "tipping",
        "Limits of acceleration and speed before it tips",
        f"{THESIS}, (2.2)-(2.7), Fig. 2.4-2.6",
        f"{HERE}.tipping:tipping",
    ),
    Study(
        "delay",
        "Pure pursuit over a slow link: from which delay on it swings",
        f"{THESIS}, (5.3)-(5.5), 6.1, App. B",
        f"{HERE}.delay:delay",
    ),
    Study(
        "video",
        "Pure pursuit by two pictures a second, each half a second old",
        f"{THESIS}, App. A, 6.1",
        f"{HERE}.video:video",
    ),
    Study(
        "predictor",
        "Pure pursuit over a slow link with and without the predictor, through the whole chain",
        f"{THESIS}, 5.3, 5.4, 6.1",
        f"{HERE}.predictor:predictor",
    ),
    Study(
        "dynamic_predictor",
        "A predictor by the robot's equation of motion",
        f"{THESIS}, (6.1), (3.31)-(3.34)",
        f"{HERE}.dynamic_predictor:dynamic_predictor",
    ),
    Study(
        "steering_lag",
        "From which delay on pure pursuit swings where the steering lags",
        f"{THESIS}, App. B, Fig. B.1",
        f"{HERE}.steering_lag:steering_lag",
    ),
    Study(
        "steering",
        "The steering's step under computed torque, and its model 10 % wrong",
        f"{THESIS}, (3.85)-(3.102)",
        f"{HERE}.steering:steering",
    ),
    Study(
        "computed_torque",
        "Computed torque through the emulated EPOS2 on the bus: 20 mm of the rack",
        f"{THESIS}, 3.5.1, 3.5.2, (3.99)-(3.102), Fig. 3.23, 3.24",
        f"{HERE}.computed_torque:computed_torque",
    ),
    Study(
        "torques",
        "The torques that drive it round a circle of 5 m, flat and on a ramp",
        f"{THESIS}, (3.13)-(3.44), Fig. 3.4 and after",
        f"{HERE}.torques:torques",
    ),
    Study(
        "slopes",
        "How steep a slope it climbs, and how much its wheels slip",
        f"{THESIS}, 2.3.2, 3.3.4, 3.4.5, (3.83)",
        f"{HERE}.slopes:slopes",
    ),
    Study(
        "step",
        "Over a step of 20 mm: pushes, loads on springs, a wheel in the air",
        f"{THESIS}, 2.3, Fig. 2.3",
        f"{HERE}.step:step",
    ),
    Study(
        "line_and_circles",
        "Line and circles through the whole chain, and what its odometry is off",
        f"{THESIS}, 4.2.2, Fig. 4.18, 4.19",
        f"{HERE}.runs:line_and_circles",
    ),
    Study(
        "side_load",
        "A line of 2 m whose odometry is off, and a load aside",
        f"{THESIS}, 4.2.2, Fig. 4.12-4.15",
        f"{HERE}.side_load:side_load",
    ),
    Study(
        "slip_circle",
        "A circle of 5 m on tyres that slip: where it ends",
        f"{THESIS}, 3.4.4, 3.4.5, Fig. 3.12-3.19",
        f"{HERE}.slip_circle:slip_circle",
    ),
    Study(
        "castors",
        "A platform on two driven wheels and two castors with mass",
        f"{THESIS}, 3.2, 3.3, (3.13)-(3.40)",
        f"{HERE}.castors:castors",
    ),
    Study(
        "nine_coordinates",
        "The equation of motion by nine coordinates, steered wheels with mass",
        f"{THESIS}, 3.4.2, 3.4.3, (3.46)-(3.76)",
        f"{HERE}.nine_coordinates:nine_coordinates",
    ),
    Study(
        "magic_formula",
        "The magic formula beside the thesis's own friction over slip",
        f"{THESIS}, (3.45), (3.83)",
        f"{HERE}.magic_formula:magic_formula",
    ),
    Study(
        "sizing",
        "What its motors must give: traction, steering, screw",
        f"{THESIS}, (2.9)-(2.18), (C.1)",
        f"{HERE}.sizing:sizing",
    ),
    Study(
        "turning_circle",
        "The smallest circle that its steering turns on, within bounds",
        f"{THESIS}, App. C",
        f"{HERE}.turning_circle:turning_circle",
    ),
)
