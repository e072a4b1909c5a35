"""`new --kind axis`: the words of the command line to a robot file of one axis."""

from dataclasses import dataclass
from typing import Final

from emulators.robots.commands.kind_options import KindOptions, write_file

UNITS: Final = ("rad", "m")
COMMANDS: Final = ("position", "speed")
NODES: Final = range(1, 128)


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisOptions(KindOptions):
    """The options of an axis, with their defaults."""

    nodes: str = "1"
    family: str = "cia402"
    command: str = "position"
    unit: str = "rad"
    travel: str | None = None
    inertia: float
    motor: str = "RE40"
    gear: float = 43.0
    encoder_lines: int = 500
    voltage: float = 24.0
    speed: float = 1.0
    acceleration: float = 5.0

    def write(self) -> None:
        """Write the robot file."""
        from emulators import motors
        from emulators.family import families
        from emulators.new_drive import AxisDrive
        from emulators.robots.servo_axis.starter import AxisSpecification, robot_file
        from emulators.specification import ENCODER_LINES, SpecificationError, one_of, positive, within

        able = {name: one for name, one in families().items() if one.axis_table is not None}
        one_of("--family", "", self.family, list(able))
        one_of("--unit", "", self.unit, UNITS)
        one_of("--command", "", self.command, COMMANDS)
        if not self.nodes.isdecimal() or int(self.nodes) not in NODES:
            raise SpecificationError(f"--nodes: one CANopen node, 1 to 127, not '{self.nodes}'")
        by_position = self.command == "position"
        travel = _travel(self.travel)
        if by_position is (travel is None):
            needs = "needs --travel" if by_position else "takes no --travel"
            raise SpecificationError(f"--command {self.command} {needs}: LOW,HIGH in {self.unit}")
        specified = AxisSpecification(
            name=self.name,
            unit=self.unit,
            drive=AxisDrive(
                number=int(self.nodes),
                by_position=by_position,
                motor=motors.motor(self.motor),
                encoder_lines=within("--encoder-lines", self.encoder_lines, ENCODER_LINES),
                gear=positive("--gear", self.gear),
                load=positive("--inertia", self.inertia),
                voltage_v=positive("--voltage", self.voltage),
                speed=positive("--speed", self.speed),
                acceleration=positive("--acceleration", self.acceleration),
            ),
            travel=travel,
        )
        write_file(self, robot_file(specified, able[self.family]))


def _travel(words: str | None) -> tuple[float, float] | None:
    from emulators.specification import SpecificationError

    if words is None:
        return None
    try:
        low, high = (float(word) for word in words.split(","))
    except ValueError:
        raise SpecificationError(f"--travel {words}: LOW,HIGH, as -0.8,1.8") from None
    if not low < high:
        raise SpecificationError(f"--travel {words}: the first must be below the second")
    return low, high
