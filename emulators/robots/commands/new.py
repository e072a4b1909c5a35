"""`new`: a robot of one's own, at the command line: a package for two wheels, a robot file for other kinds.

A kind is a class of options with their defaults, which writes what it makes of them.
"""

from collections.abc import Mapping
from dataclasses import MISSING, asdict, dataclass, fields
from pathlib import Path
from typing import Annotated, Any, Final

import typer

from emulators.robots.commands.axis_file import AxisOptions
from emulators.robots.commands.differential_package import DifferentialOptions
from emulators.robots.commands.kind_options import KindOptions
from emulators.robots.commands.omni_file import OmniOptions
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import one_message

EXAMPLES: Final = """Examples:

`firmware-bridge new mouse --kind differential --nodes 1,2 --wheel-radius 0.08 --track 0.35`

`pip install -e mouse`

`firmware-bridge bench mouse`

`firmware-bridge new swivel --kind axis --motor RE50 --gear 26 --inertia 0.0875 --travel=-0.8,1.8`

`firmware-bridge new tray --kind omni --wheel-radius 0.05 --wheel-distance 0.16`

`firmware-bridge bench tray.toml`"""
TWO: Final = "LEFT,RIGHT"
DIFFERENTIAL: Final = "differential"


KINDS: Final[Mapping[str, type[KindOptions]]] = {
    DIFFERENTIAL: DifferentialOptions,
    "axis": AxisOptions,
    "omni": OmniOptions,
}


def kinds() -> list[str]:
    """Return the kinds of robots that can be written."""
    return list(KINDS)


def _defaults(key: str) -> str | bool:
    """Return an option's default in each kind that takes it, as help shows it; False without any."""
    shown = {}
    for kind, options in KINDS.items():
        for one in fields(options):
            if one.name == key:
                shown[kind] = "needed" if one.default is MISSING else f"{one.default}"
    if len(shown) == len(KINDS) and len(set(shown.values())) == 1:
        return next(iter(shown.values()))
    return ", ".join(f"{kind}: {value}" for kind, value in shown.items() if value != "None") or False


def _spelled(key: str) -> str:
    return f"--{key.replace('_', '-')}"


def _option(key: str, help: str, **more: Any) -> Any:  # noqa: A002 - typer's own word
    return typer.Option(_spelled(key), help=help, show_default=_defaults(key), **more)


@dataclass(frozen=True, slots=True, kw_only=True)
class NewOptions:
    """Write a new robot that drives at once: a package for two wheels, else a robot file.

    The gains are worked out from the motor's data and the load. Check each number marked as assumed before
    the real robot moves.
    """

    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the robot, its package and its type.")]
    kind: Annotated[
        str,
        typer.Option(
            help="differential: two wheels; axis: one drive; omni: three wheels on a board.",
            autocompletion=completing("emulators.robots.commands.new:kinds"),
        ),
    ] = DIFFERENTIAL
    nodes: Annotated[str | None, _option("nodes", "CANopen nodes of its drives.", metavar=TWO)] = None
    wheel_radius: Annotated[
        float | None, _option("wheel_radius", "Radius of the driven wheels.", metavar="M")
    ] = None
    track: Annotated[float | None, _option("track", "Distance of the driven wheels.", metavar="M")] = None
    wheel_distance: Annotated[
        float | None, _option("wheel_distance", "From a wheel to the middle.", metavar="M")
    ] = None
    family: Annotated[str | None, _option("family", "Family of its drive, as `families` lists it.")] = None
    protocol: Annotated[
        str | None, _option("protocol", "Firmware of its board, as docs/fidelity-arduino.md has them.")
    ] = None
    command: Annotated[str | None, _option("command", "position, which needs --travel, or speed.")] = None
    unit: Annotated[str | None, _option("unit", "rad where it turns, m where it slides.")] = None
    travel: Annotated[
        str | None, _option("travel", "Lowest and highest position of an axis.", metavar="LOW,HIGH")
    ] = None
    inertia: Annotated[
        float | None, _option("inertia", "Of its load, behind the gear; kg of one in m.", metavar="KGM2")
    ] = None
    axes: Annotated[str | None, _option("axes", "Names of its axes.", metavar=TWO)] = None
    device: Annotated[str | None, _option("device", "Type of its drives: EPOS2 ...")] = None
    motor: Annotated[
        str | None,
        _option(
            "motor",
            "RE25, RE40, RE50; one of maxon's by order number or a part of its name; or a .toml file.",
            metavar="NAME|FILE",
            autocompletion=completing("emulators.motors:names"),
        ),
    ] = None
    gear: Annotated[
        float | None,
        _option("gear", "Turns of the motor for one of the wheel; rad for 1 of --unit.", metavar="RATIO"),
    ] = None
    encoder_lines: Annotated[
        int | None, _option("encoder_lines", "Lines of the encoder, for one turn of the motor.")
    ] = None
    mass: Annotated[float | None, _option("mass", "Mass of the loaded robot.", metavar="KG")] = None
    voltage: Annotated[float | None, _option("voltage", "Voltage of its battery.", metavar="V")] = None
    speed: Annotated[
        float | None, _option("speed", "Its speed limit; of an axis in its unit.", metavar="M/S")
    ] = None
    acceleration: Annotated[
        float | None, _option("acceleration", "Greatest acceleration, loaded.", metavar="M/S2")
    ] = None
    turn_rate: Annotated[float | None, _option("turn_rate", "Its turn rate limit.", metavar="RAD/S")] = None
    folder: Annotated[
        Path | None,
        typer.Option(
            "--dir", metavar="DIR", help="Folder of the package or file.", show_default="NAME, or here"
        ),
    ] = None


def write(given: NewOptions) -> None:
    """Write the robot of these options; an error ends the program with a message."""
    from emulators.motors import MotorError
    from emulators.specification import SpecificationError, one_of, usable
    from firmware_bridge.robot import RobotFileError

    with one_message(SpecificationError, MotorError, RobotFileError):
        usable("NAME", given.name)
        kind = one_of("--kind", "kind ", given.kind, kinds())
        words = {key: value for key, value in asdict(given).items() if value is not None and key != "kind"}
        known = {one.name: one.default for one in fields(KINDS[kind])}
        for key in words.keys() - known.keys():
            raise SpecificationError(f"{_spelled(key)}: a robot of the kind {kind} takes no such option")
        for key, default in known.items():
            if default is MISSING and key not in words:
                raise SpecificationError(f"{_spelled(key)}: a robot of the kind {kind} needs it")
        KINDS[kind](**words).write()


new: Final = command(EXAMPLES, work=write)(NewOptions)
