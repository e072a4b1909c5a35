"""Faults of the operator's link, and of the serial line between bridge and drives."""

from abc import ABC, abstractmethod
from collections.abc import Iterator
from typing import Annotated, ClassVar, Final, Literal

from numpy.random import Generator
from pydantic import Field

from emulators.bench.faults.fault import Lasting, NonNegative, Positive, Problem, Share, Stations
from emulators.bench.faults.site import Site
from emulators.wires import Impairment
from emulators.world import WorldError
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.table import Medium
from firmware_bridge.units import MILLISECOND

OPERATORS_LINK: Final = "the operator's link is the bridge's: `drive --link delay=...` impairs it"
Sender = Annotated[
    Literal["operator", "bridge"] | None,
    Field(description="sender of the datagrams; without it both directions"),
]


class _Datagrams(Lasting, ABC):
    among: ClassVar = Stations.NONE
    sender: Sender = None
    share: Share = 1.0

    def put_on(self, site: Site, chance: Generator) -> None:
        """Impair the link."""
        site.operator.impair(self.impairment(chance))

    @abstractmethod
    def impairment(self, chance: Generator) -> Impairment:
        """Return what becomes of the datagrams."""


class DatagramLoss(_Datagrams):
    """Datagrams are lost."""

    kind: ClassVar = "datagram_loss"
    bench_only: ClassVar = OPERATORS_LINK

    def impairment(self, chance: Generator) -> Impairment:
        """Lose them."""
        return Impairment(self.sender, self.begin, self.end, self.share, chance, lost=True)


class DatagramLate(_Datagrams):
    """Datagrams come late."""

    kind: ClassVar = "datagram_late"
    bench_only: ClassVar = OPERATORS_LINK
    by_ms: Annotated[Positive, Field(description="delay beyond the link's own, in ms")]

    def impairment(self, chance: Generator) -> Impairment:
        """Delay them."""
        late = round(self.by_ms * MILLISECOND)
        return Impairment(self.sender, self.begin, self.end, self.share, chance, late=late)


class DatagramDoubled(_Datagrams):
    """Datagrams come twice."""

    kind: ClassVar = "datagram_doubled"
    bench_only: ClassVar = OPERATORS_LINK
    after_ms: Annotated[NonNegative, Field(description="interval between the two, in ms")] = 0.0

    def impairment(self, chance: Generator) -> Impairment:
        """Double them."""
        again = round(self.after_ms * MILLISECOND)
        return Impairment(self.sender, self.begin, self.end, self.share, chance, again=again)


class SerialUnplugged(Lasting):
    """The adapter between the bridge and the serial line is pulled out."""

    kind: ClassVar = "serial_unplugged"
    bench_only: ClassVar = "the port is open in the program under test: end it, or pull its plug"
    among: ClassVar = Stations.NONE

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the equipment that this robot lacks for it."""
        if all(link.medium is not Medium.SERIAL for link in robot.links.values()):
            yield "kind", f"{robot.name} is not on a serial line; --serial v1 or v2 puts it there"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Pull it out."""
        del chance
        self._plug(site, plugged=False)

    def take_off(self, site: Site) -> None:
        """Plug it in."""
        self._plug(site, plugged=True)

    def _plug(self, site: Site, *, plugged: bool) -> None:
        if not site.bridges.adapters:
            raise WorldError(f"{self.kind}: this bench has no serial line")
        for adapter in site.bridges.adapters:
            adapter.plugged = plugged
