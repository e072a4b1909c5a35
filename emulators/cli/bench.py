"""`bench`: a mission in virtual time, at the command line."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.cli.options import PlantOption, SerialOption
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.options import (
    EncodersOption,
    FirmwareOption,
    MaxDelayOption,
    PathOption,
    PathSpeedOption,
    RobotArgument,
    SlowLinkOption,
)

EXAMPLES: Final = """Examples:

`firmware-bridge bench rars --mission line`

`firmware-bridge bench rars --mission line --serial v2` drives over the first drive's serial port.

`firmware-bridge bench rome --mission line --protocol arduinoio --encoders 3` drives over another firmware.

`firmware-bridge bench rome --path my_path.csv` has the guide drive along the points of a file.
`firmware-bridge bench rars --mission line --link delay=0.6,jitter=0.1,up.loss=0.02` drives over a slow link.

`firmware-bridge bench rars --mission pursuit --link delay=0.8 --predictor` follows a circle over the link.

`firmware-bridge bench rars --mission my_mission.toml --seed 7 --out results`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class BenchOptions:
    """Drive a mission in virtual time: bridge, bus, drives and plant, all in this process.

    Leaves `report.html`, which has it all on one page, `summary.json`, `samples.csv`, `can.log` (as candump),
    `serial.log`, `operator.tlog`, `capture.log` where cameras see the robot, and plots in the results'
    folder, which `replay` plays again.
    """

    robot: RobotArgument
    mission: Annotated[
        str | None,
        typer.Option(
            "--mission",
            "-m",
            metavar="NAME|FILE",
            help="A shipped mission of the robot, or a mission file (.toml).",
            show_default="the robot's first; with --path one that drives along it",
            autocompletion=completing("emulators.bench.rehearsal:mission_names"),
        ),
    ] = None
    seed: Annotated[
        int, typer.Option("--seed", "-s", min=0, help="Chooses the noise; one seed, one run.")
    ] = 0
    out: Annotated[
        Path | None,
        typer.Option(
            "--out", "-o", metavar="DIR", help="Where the results go.", show_default="out/ROBOT-MISSION"
        ),
    ] = None
    plant: PlantOption = None
    serial: SerialOption = None
    link: SlowLinkOption = None
    max_delay: MaxDelayOption = None
    predictor: Annotated[
        bool,
        typer.Option("--predictor", help="Let the mission's pilot drive by where the robot will be."),
    ] = False
    protocol: FirmwareOption = None
    encoders: EncodersOption = None
    path: PathOption = None
    path_speed: PathSpeedOption = None


bench: Final = command(EXAMPLES, work="emulators.cli.bench_work:bench")(BenchOptions)
