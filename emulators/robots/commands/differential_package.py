"""`new --kind differential`: the words of the command line to a package of two wheels."""

from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from emulators.robots.commands.kind_options import KindOptions
from firmware_bridge.cli.console import say, written_by

if TYPE_CHECKING:
    from emulators.epos2.starter.numbers import Specification

NODES: Final = range(1, 128)
ENCODER_LINES: Final = range(16, 2_500_001)
"""Of an EPOS2's 0x2210:01."""
WHEELS: Final = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class DifferentialOptions(KindOptions):
    """The options of two wheels, with their defaults."""

    nodes: str = "1,2"
    wheel_radius: float
    track: float
    axes: str = "left,right"
    device: str = "70/10"
    motor: str = "RE40"
    gear: float = 43.0
    encoder_lines: int = 500
    mass: float = 25.0
    voltage: float = 24.0
    speed: float = 0.6
    acceleration: float = 0.5
    turn_rate: float = 1.2

    def write(self) -> None:
        """Write the package and say what comes next."""
        from emulators import motors
        from emulators.epos2.starter.numbers import Specification
        from emulators.epos2.starter.package import write
        from emulators.specification import one_of, positive, within
        from firmware_bridge.families.epos2.settings import Epos2Device

        types = [one.value for one in Epos2Device]
        _free(self.name)
        specified = Specification(
            kind="differential",
            name=self.name,
            nodes=_nodes(self.nodes),
            axes=_axes(self.axes),
            device=Epos2Device(one_of("--device", "EPOS2 ", self.device, types)),
            motor=motors.motor(self.motor),
            encoder_lines=within("--encoder-lines", self.encoder_lines, ENCODER_LINES),
            wheel_radius_m=positive("--wheel-radius", self.wheel_radius),
            track_m=positive("--track", self.track),
            gear=positive("--gear", self.gear),
            mass_kg=positive("--mass", self.mass),
            voltage_v=positive("--voltage", self.voltage),
            speed_mps=positive("--speed", self.speed),
            acceleration_mps2=positive("--acceleration", self.acceleration),
            turn_rate_rad_s=positive("--turn-rate", self.turn_rate),
        )
        target = self.folder or Path(self.name)
        with written_by("--dir"):
            paths = write(specified, target)
        _report(specified, target, len(paths))


def _report(specified: "Specification", target: Path, files: int) -> None:
    name = specified.name
    given, wanted = specified.device.continuous_ma / 1000.0, specified.motor.continuous_current_a
    # The robot file keeps within the drive: the motor could bear more.
    if wanted > given:
        say(
            f"the motor's {wanted:g} A are more than an EPOS2 {specified.device.value} gives: "
            f"{given:g} A are written"
        )
    if specified.motor.kind == "ec" and specified.motor.pole_pairs is None:
        say(
            f"no source states the pole pairs of {specified.motor.title}: set 0x6410:3 in EPOS Studio, or "
            f"write pole_pairs beside motor_type in src/{name}/{name}.toml"
        )
    say(f"{target}: {files} files; before it moves check what src/{name}/{name}.toml marks as assumed")
    say(f"next: pip install -e {target}")
    say(f"then: firmware-bridge bench {name}")


def _nodes(words: str) -> tuple[int, int]:
    from emulators.specification import SpecificationError

    left, right = _two("--nodes", words)
    for node in (left, right):
        if not node.isdecimal() or int(node) not in NODES:
            raise SpecificationError(f"--nodes: a CANopen node is a number from 1 to 127, not '{node}'")
    return int(left), int(right)


def _axes(words: str) -> tuple[str, str]:
    from emulators.specification import usable

    left, right = _two("--axes", words)
    return usable("--axes", left), usable("--axes", right)


def _free(name: str) -> None:
    """Refuse a name that Python, or an installed package, has already; SpecificationError."""
    from emulators.specification import SpecificationError
    from firmware_bridge import robot_types as installed
    from fmu import plants

    if name in installed.names():
        raise SpecificationError(f"NAME: the robot '{name}' is installed already; take another name")
    if name in plants.names():
        raise SpecificationError(f"NAME: the plant '{name}' is installed already; take another name")
    # A package of that name would hide the other one, or be hidden by it.
    if find_spec(name) is not None:
        raise SpecificationError(f"NAME: there is a Python package '{name}' already; take another name")


def _two(option: str, words: str) -> tuple[str, str]:
    """Return the left and the right word; SpecificationError."""
    from emulators.specification import SpecificationError

    found = [word.strip() for word in words.split(",")]
    if len(found) != WHEELS:
        raise SpecificationError(f"{option}: two with a comma between, left and right, not '{words}'")
    if found[0] == found[1]:
        raise SpecificationError(f"{option}: '{found[0]}' stands twice; each wheel has its own")
    return found[0], found[1]
