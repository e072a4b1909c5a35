"""Faults of one drive: its supplies, its air, its encoder."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.fault import Lasting, Node, Positive, Problem, Stations
from emulators.bench.faults.site import Site
from emulators.canopen.slave import CanopenSlave
from emulators.servo.axis import AMBIENT_MC, GATE_MV, LOGIC_MV, ServoAxis
from emulators.servo.sensors import BROKEN, INDEX_MISSING, INDEX_SPURIOUS
from firmware_bridge.robot import AnyRobot

MILLI = 1000
One = Annotated[Node, Field(description="affected drive")]
Any = Annotated[Node | None, Field(description="affected drive; without it all drives")]


class DriveRestart(Lasting):
    """A drive loses its supply and starts again."""

    kind: ClassVar = "drive_restart"
    node: One

    def put_on(self, site: Site, chance: Generator) -> None:
        """Switch it off."""
        del chance
        for name in self.targets(site.robot):
            site.switch_off(name)

    def take_off(self, site: Site) -> None:
        """Switch it on."""
        for name in self.targets(site.robot):
            site.switch_on(name)


class SetPointsIgnored(Lasting):
    """A drive continues with its last command and takes no new one."""

    kind: ClassVar = "set_points_ignored"
    node: One

    def put_on(self, site: Site, chance: Generator) -> None:
        """Make it ignore new commands."""
        del chance
        for name in self.targets(site.robot):
            site.devices.nodes(CanopenSlave)[name].hang(hung=True)

    def take_off(self, site: Site) -> None:
        """Make it execute commands again."""
        for name in self.targets(site.robot):
            site.devices.nodes(CanopenSlave)[name].hang(hung=False)


class _OnAxes(Lasting, ABC):
    """A fault that is a state of the servo axes."""

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it begin at all that it meets."""
        del chance
        for name in self.targets(site.robot):
            self.begin_at(site.devices.motors(ServoAxis)[name])

    def take_off(self, site: Site) -> None:
        """Let it end at all that it meets."""
        for name in self.targets(site.robot):
            self.end_at(site.devices.motors(ServoAxis)[name])

    @abstractmethod
    def begin_at(self, axis: ServoAxis) -> None:
        """Let it begin at one axis."""

    @abstractmethod
    def end_at(self, axis: ServoAxis) -> None:
        """Let it end at one axis."""


class _Supply(_OnAxes):
    """The voltage at the drives differs from the battery's."""

    node: Any = None
    to_v: Annotated[float, Field(gt=0, le=1000, description="voltage at the drive, in V")]

    def begin_at(self, axis: ServoAxis) -> None:
        """Put the voltage on."""
        axis.force_supply(max(1, round(self.to_v * MILLI)))

    def end_at(self, axis: ServoAxis) -> None:
        """Leave the drive to the battery."""
        axis.force_supply(0)


class SupplySag(_Supply):
    """The supply sags."""

    kind: ClassVar = "supply_sag"

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the reasons why it does not fit this robot."""
        yield from super().problems(robot)
        if robot.battery is not None and self.to_v >= robot.battery.nominal_v:
            yield "to_v", f"{self.to_v:g} V is no sag of a supply of {robot.battery.nominal_v:g} V"


class SupplySurge(_Supply):
    """The supply rises."""

    kind: ClassVar = "supply_surge"

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the reasons why it does not fit this robot."""
        yield from super().problems(robot)
        if robot.battery is not None and self.to_v <= robot.battery.nominal_v:
            yield "to_v", f"{self.to_v:g} V is no surge of a supply of {robot.battery.nominal_v:g} V"


class LogicSupplySag(_OnAxes):
    """The drive's own 5 V sag."""

    kind: ClassVar = "logic_supply_sag"
    node: One
    to_v: Annotated[float, Field(ge=0, lt=LOGIC_MV / MILLI, description="remaining voltage of 5 V, in V")]

    def begin_at(self, axis: ServoAxis) -> None:
        """Pull it down."""
        axis.logic_mv = round(self.to_v * MILLI)

    def end_at(self, axis: ServoAxis) -> None:
        """Let it rise."""
        axis.logic_mv = LOGIC_MV


class GateSupplySag(_OnAxes):
    """The gate drivers' supply sags."""

    kind: ClassVar = "gate_supply_sag"
    node: One
    to_v: Annotated[float, Field(ge=0, lt=GATE_MV / MILLI, description="remaining voltage of 12 V, in V")]

    def begin_at(self, axis: ServoAxis) -> None:
        """Pull it down."""
        axis.gate_mv = round(self.to_v * MILLI)

    def end_at(self, axis: ServoAxis) -> None:
        """Let it rise."""
        axis.gate_mv = GATE_MV


class Overheating(_OnAxes):
    """The air at the heat sink is hot."""

    kind: ClassVar = "overheating"
    node: Any = None
    to_celsius: Annotated[
        float,
        Field(
            gt=AMBIENT_MC / MILLI, le=500, description="air temperature at the heat sink, in degrees Celsius"
        ),
    ]

    def begin_at(self, axis: ServoAxis) -> None:
        """Heat it."""
        axis.ambient_mc = round(self.to_celsius * MILLI)

    def end_at(self, axis: ServoAxis) -> None:
        """Cool it."""
        axis.ambient_mc = AMBIENT_MC


class _Wires(_OnAxes):
    """A fault in the wires of the encoder."""

    node: One
    wrong: ClassVar[int]
    """Bit of the axis' `sensor_faults`."""

    def begin_at(self, axis: ServoAxis) -> None:
        """Spoil them."""
        axis.sensor_faults |= self.wrong

    def end_at(self, axis: ServoAxis) -> None:
        """Repair them."""
        axis.sensor_faults &= ~self.wrong


class EncoderCut(_Wires):
    """The encoder's cable is cut."""

    kind: ClassVar = "encoder_cut"
    wrong: ClassVar = BROKEN


class EncoderSwapped(Lasting):
    """The encoder's channels are exchanged: of a drive's axis, or of a motor at a shield."""

    kind: ClassVar = "encoder_swapped"
    among: ClassVar = Stations.ENCODERS
    node: Annotated[Node, Field(description="affected drive or motor")]

    def put_on(self, site: Site, chance: Generator) -> None:
        """Exchange them."""
        del chance
        self._exchange(site, swapped=True)

    def take_off(self, site: Site) -> None:
        """Put them back."""
        self._exchange(site, swapped=False)

    def _exchange(self, site: Site, *, swapped: bool) -> None:
        for name in self.targets(site.robot):
            next(axis for axis in site.devices.axes if axis.name == name).swap_channels(swapped=swapped)


class IndexMissing(_Wires):
    """The encoder's index does not come."""

    kind: ClassVar = "index_missing"
    wrong: ClassVar = INDEX_MISSING


class IndexSpurious(_Wires):
    """A second index comes in each turn."""

    kind: ClassVar = "index_spurious"
    wrong: ClassVar = INDEX_SPURIOUS


class EncoderCountsLost(_OnAxes):
    """Some counts of the encoder are lost."""

    kind: ClassVar = "encoder_counts_lost"
    node: One
    share: Annotated[
        Positive, Field(ge=0.001, le=1, description="share of the quadcounts, in steps of 0.001")
    ]

    def begin_at(self, axis: ServoAxis) -> None:
        """Lose counts."""
        axis.encoder_loss = round(self.share * MILLI)

    def end_at(self, axis: ServoAxis) -> None:
        """Lose no more."""
        axis.encoder_loss = 0


class EncoderFrozen(_OnAxes):
    """The encoder's disc does not turn with the shaft."""

    kind: ClassVar = "encoder_frozen"
    node: One

    def begin_at(self, axis: ServoAxis) -> None:
        """Free the disc: no count and no index any more."""
        # All counts lost, but not the cable: the drive must not report a sensor breach (FF0A).
        axis.encoder_loss = MILLI
        axis.sensor_faults |= INDEX_MISSING

    def end_at(self, axis: ServoAxis) -> None:
        """Hold it again."""
        axis.encoder_loss = 0
        axis.sensor_faults &= ~INDEX_MISSING
