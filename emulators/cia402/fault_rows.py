"""The fault of a drive that does otherwise than most, one row."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Final

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.device import One
from emulators.bench.faults.fault import Fault, Problem
from emulators.bench.faults.kind import FaultKind
from emulators.bench.faults.site import Site
from emulators.cia402.servo import Servo
from emulators.cia402.variations import VARIATIONS, traits_of
from firmware_bridge.families.cia402.settings import Cia402Axis, Cia402Link, Home
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import near


class DriveVariation(Fault):
    """A drive is exchanged for a difficult but lawful one."""

    kind: ClassVar = "drive_variation"
    node: One
    names: Annotated[
        tuple[str, ...],
        Field(min_length=1, strict=False, description="variations, by their names in docs/variations.md"),
    ]

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield a name that no variation has, and a drive of another family."""
        yield from (
            ("names", f"no variation '{name}'; {near(name, VARIATIONS)}")
            for name in self.names
            if name not in VARIATIONS
        )
        yield from super().problems(robot)
        servos = [axis for axis in robot.axes if axis.link in Cia402Link.all_of(robot)]
        known = {name for axis in servos for name in (axis.name, str(Cia402Axis.of(axis).node))}
        if not servos:
            yield "kind", f"{robot.name} has no CiA 402 drive"
        elif str(self.node) not in known:
            yield "node", f"'{self.node}' is no CiA 402 drive; {near(str(self.node), known)}"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Exchange it, without power, and switch it on."""
        del chance
        for name in self.targets(site.robot):
            drive = site.devices.nodes(Servo)[name]
            axis = next(axis for axis in site.robot.axes if axis.name == name)
            itself = Cia402Axis.of(axis).home is Home.ITSELF
            traits = traits_of(self.names)
            site.switch_off(name)
            # As the robot file reads 0x607C, but where this is the variation: then it is the other way.
            drive.become(traits.with_(offset_added=itself != traits.offset_added))
            site.switch_on(name)


ROWS: Final = (
    FaultKind(
        DriveVariation,
        "The drive is exchanged for one that keeps to CiA 402, and does otherwise than most where it may."
        " Instantaneous: no end.",
        "A CiA 402 drive: starts as after power-on, with what `docs/variations.md` has by its name.",
        severe=({"names": ("resumes-after-quick-stop", "no-option-codes")},),
    ),
)
