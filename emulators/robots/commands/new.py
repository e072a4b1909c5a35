"""`new`: a robot of one's own, at the command line: a package for two wheels, a robot file for one axis."""

import keyword
import math
import re
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Final

import typer

from emulators.robots.commands.axis_file import AxisOptions, write_axis
from firmware_bridge import robot_types as installed
from firmware_bridge.cli.commands import command, completing
from firmware_bridge.cli.console import one_message, say, written_by

NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,19}")

WHEELS: Final = 2

NODES: Final = range(1, 128)

ENCODER_LINES: Final = range(16, 2_500_001)


EXAMPLES: Final = """Examples:

`firmware-bridge new mouse --kind differential --nodes 1,2 --wheel-radius 0.08 --track 0.35`

`pip install -e mouse`

`firmware-bridge bench mouse`

`firmware-bridge new swivel --kind axis --motor RE50 --gear 26 --inertia 0.0875 --travel -0.8,1.8`

`firmware-bridge bench swivel.toml`"""
AXIS: Final = "axis"
DIFFERENTIAL: Final = "differential"
ONE_NODE: Final = "1"
TWO_NODES: Final = "1,2"
AXIS_SPEED, AXIS_ACCELERATION = 1.0, 5.0

TWO: Final = "LEFT,RIGHT"


@command(EXAMPLES)
def new(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Name of the robot, its package and its type.")],
    *,
    kind: Annotated[
        str,
        typer.Option(
            "--kind",
            help="Type of the robot: differential, two wheels; or axis, one drive.",
            autocompletion=completing("emulators.robots.commands.new:kinds"),
        ),
    ] = "differential",
    nodes: Annotated[
        str | None,
        typer.Option(
            "--nodes", metavar=TWO, help="CANopen nodes of its drives.", show_default="1,2; 1 of an axis"
        ),
    ] = None,
    wheel_radius: Annotated[
        float | None,
        typer.Option("--wheel-radius", metavar="M", help="Differential: radius of the driven wheels."),
    ] = None,
    track: Annotated[
        float | None,
        typer.Option("--track", metavar="M", help="Differential: distance of the driven wheels."),
    ] = None,
    family: Annotated[
        str, typer.Option("--family", help="Axis: family of its drive, as `families` lists it.")
    ] = "cia402",
    command: Annotated[
        str, typer.Option("--command", help="Axis: position, which needs --travel, or speed.")
    ] = "position",
    unit: Annotated[str, typer.Option("--unit", help="Axis: rad where it turns, m where it slides.")] = "rad",
    travel: Annotated[
        str | None,
        typer.Option("--travel", metavar="LOW,HIGH", help="Axis: its lowest and highest position."),
    ] = None,
    inertia: Annotated[
        float | None,
        typer.Option("--inertia", metavar="KGM2", help="Axis: of its load, behind the gear; kg of one in m."),
    ] = None,
    axes: Annotated[str, typer.Option("--axes", metavar=TWO, help="Names of its axes.")] = "left,right",
    device: Annotated[str, typer.Option("--device", help="Type of its drives: EPOS2 ...")] = "70/10",
    motor: Annotated[
        str,
        typer.Option(
            "--motor",
            metavar="NAME|FILE",
            help="RE25, RE40, RE50; one of maxon's by order number or a part of its name; or a .toml file.",
            autocompletion=completing("emulators.motors:names"),
        ),
    ] = "RE40",
    gear: Annotated[
        float,
        typer.Option(
            "--gear", metavar="RATIO", help="Turns of the motor for one of the wheel; rad for 1 of --unit."
        ),
    ] = 43.0,
    encoder_lines: Annotated[
        int, typer.Option("--encoder-lines", help="Lines of the encoder, for one turn of the motor.")
    ] = 500,
    mass: Annotated[float, typer.Option("--mass", metavar="KG", help="Mass of the loaded robot.")] = 25.0,
    voltage: Annotated[float, typer.Option("--voltage", metavar="V", help="Voltage of its battery.")] = 24.0,
    speed: Annotated[
        float | None,
        typer.Option("--speed", metavar="M/S", help="Its speed limit.", show_default="0.6; 1 of an axis"),
    ] = None,
    acceleration: Annotated[
        float | None,
        typer.Option(
            "--acceleration",
            metavar="M/S2",
            help="Greatest acceleration, loaded.",
            show_default="0.5; 5 of an axis",
        ),
    ] = None,
    turn_rate: Annotated[
        float, typer.Option("--turn-rate", metavar="RAD/S", help="Its turn rate limit.")
    ] = 1.2,
    folder: Annotated[
        Path | None,
        typer.Option("--dir", metavar="DIR", help="Folder of the package.", show_default="NAME"),
    ] = None,
) -> None:
    """Write a new robot that drives at once: a package for two wheels, a robot file for one axis.

    The gains are worked out from the motor's data and the load. Check each number marked as assumed before
    the real robot moves.
    """
    from emulators import motors
    from emulators.epos2.starter.numbers import Specification, SpecificationError
    from emulators.epos2.starter.package import write
    from emulators.motors import MotorError
    from firmware_bridge.families.epos2.settings import Epos2Device

    if kind == AXIS:
        axis = AxisOptions(
            name=name,
            node=nodes or ONE_NODE,
            family=family,
            command=command,
            unit=unit,
            travel=travel,
            inertia=inertia,
            motor=motor,
            gear=gear,
            encoder_lines=encoder_lines,
            voltage=voltage,
            speed=AXIS_SPEED if speed is None else speed,
            acceleration=AXIS_ACCELERATION if acceleration is None else acceleration,
            folder=folder,
        )
        write_axis(axis)
        return
    target = folder or Path(name)
    with one_message(SpecificationError, MotorError):
        types = [one.value for one in Epos2Device]
        _free(name)
        specified = Specification(
            kind=_known("--kind", "kind", kind, kinds()),
            name=name,
            nodes=_nodes(nodes or TWO_NODES),
            axes=_axes(axes),
            device=Epos2Device(_known("--device", "EPOS2", device, types)),
            motor=motors.motor(motor),
            encoder_lines=_lines(encoder_lines),
            wheel_radius_m=_positive("--wheel-radius", _needed("--wheel-radius", wheel_radius)),
            track_m=_positive("--track", _needed("--track", track)),
            gear=_positive("--gear", gear),
            mass_kg=_positive("--mass", mass),
            voltage_v=_positive("--voltage", voltage),
            speed_mps=_positive("--speed", 0.6 if speed is None else speed),
            acceleration_mps2=_positive("--acceleration", 0.5 if acceleration is None else acceleration),
            turn_rate_rad_s=_positive("--turn-rate", turn_rate),
        )
        with written_by("--dir"):
            paths = write(specified, target)
    given, wanted = specified.device.continuous_ma / 1000.0, specified.motor.continuous_current_a
    # The robot file keeps within the drive: the motor could bear more.
    if wanted > given:
        say(f"the motor's {wanted:g} A are more than an EPOS2 {device} gives: {given:g} A are written")
    if specified.motor.kind == "ec" and specified.motor.pole_pairs is None:
        say(
            f"no source states the pole pairs of {specified.motor.title}: set 0x6410:3 in EPOS Studio, or "
            f"write pole_pairs beside motor_type in src/{name}/{name}.toml"
        )
    say(f"{target}: {len(paths)} files; before it moves check what src/{name}/{name}.toml marks as assumed")
    say(f"next: pip install -e {target}")
    say(f"then: firmware-bridge bench {name}")


def kinds() -> list[str]:
    """Return the kinds of robots that can be written."""
    from emulators.epos2.starter import package

    return [AXIS, *package.kinds()]


def _needed(option: str, value: float | None) -> float:
    from emulators.epos2.starter.numbers import SpecificationError

    if value is None:
        raise SpecificationError(f"{option}: a robot of the kind {DIFFERENTIAL} needs it")
    return value


def _known(option: str, what: str, name: str, known: list[str]) -> str:
    from emulators.epos2.starter.numbers import SpecificationError
    from firmware_bridge.robot.problems import near

    if name not in known:
        raise SpecificationError(f"{option}: no {what} '{name}'; {near(name, known)}")
    return name


def _positive(option: str, value: float) -> float:
    from emulators.epos2.starter.numbers import SpecificationError

    if not 0.0 < value < math.inf:
        raise SpecificationError(f"{option} must be positive, not {value:g}")
    return value


def _lines(encoder_lines: int) -> int:
    from emulators.epos2.starter.numbers import SpecificationError

    if encoder_lines not in ENCODER_LINES:
        raise SpecificationError(f"--encoder-lines must be 16 to 2500000, not {encoder_lines}")
    return encoder_lines


def _nodes(words: str) -> tuple[int, int]:
    from emulators.epos2.starter.numbers import SpecificationError

    left, right = _two("--nodes", words)
    for node in (left, right):
        if not node.isdecimal() or int(node) not in NODES:
            raise SpecificationError(f"--nodes: a CANopen node is a number from 1 to 127, not '{node}'")
    return int(left), int(right)


def _axes(words: str) -> tuple[str, str]:
    named = _two("--axes", words)
    for axis in named:
        _usable("--axes", axis)
    return named


def _free(name: str) -> None:
    """Refuse a name that Python, or an installed package, has already."""
    from emulators.epos2.starter.numbers import SpecificationError
    from fmu import plants

    _usable("NAME", name)
    if name in installed.names():
        raise SpecificationError(f"NAME: the robot '{name}' is installed already; take another name")
    if name in plants.names():
        raise SpecificationError(f"NAME: the plant '{name}' is installed already; take another name")
    # A package of that name would hide the other one, or be hidden by it.
    if find_spec(name) is not None:
        raise SpecificationError(f"NAME: there is a Python package '{name}' already; take another name")


def _usable(option: str, name: str) -> None:
    from emulators.epos2.starter.numbers import SpecificationError

    if NAME.fullmatch(name) is None or keyword.iskeyword(name):
        raise SpecificationError(
            f"{option}: '{name}' is no name: small letters, digits and _, a letter first, at most 20"
        )


def _two(option: str, words: str) -> tuple[str, str]:
    """Return the left and the right word."""
    from emulators.epos2.starter.numbers import SpecificationError

    found = [word.strip() for word in words.split(",")]
    if len(found) != WHEELS:
        raise SpecificationError(f"{option}: two with a comma between, left and right, not '{words}'")
    if found[0] == found[1]:
        raise SpecificationError(f"{option}: '{found[0]}' stands twice; each wheel has its own")
    return found[0], found[1]
