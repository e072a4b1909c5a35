"""The robot on the bench: the inputs of a mission's step, the station's messages, and the figures."""

from pathlib import Path
from typing import Annotated, Final, Literal

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.columns import PLANAR, Column
from emulators.bench.differential import (
    CHANNELS,
    DEMANDED,
    SPEED_PANEL,
    TURN_PANEL,
    DifferentialStep,
    remarks,
    stick,
    twist,
)
from emulators.bench.step import Presses, Sends

from diff_drive.cases import cases

BUTTONS: Final = {"lamp": 1, "emergency_stop": 4}
_RELAY: Final = 181


class OwnStep(DifferentialStep):
    """The operator's input at one instant: one field for each of a mission's inputs."""

    lamp: Annotated[bool | None, Sends(_RELAY, lambda on, _: (0.0, float(on)), -1)] = None
    press: Annotated[Literal["lamp", "emergency_stop"] | None, Presses(BUTTONS)] = None
    """Tap a button of the stick."""


BENCH_SETUP: Final = BenchSetup(
    step=OwnStep,
    missions=Path(__file__).with_name("missions"),
    channels=CHANNELS,
    stick=stick,
    twist=twist,
    columns=(*PLANAR, *DEMANDED, Column("battery_v", "at the drives", "V", plant="battery_voltage")),
    panels=(SPEED_PANEL, TURN_PANEL),
    remarks=remarks,
    cases=cases,
)
