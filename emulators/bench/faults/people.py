"""Actions of people: end, kill or suspend the bridge; start a second one; join with a second station."""

from collections.abc import Iterator
from typing import Annotated, ClassVar, Final, Literal, Self

from numpy.random import Generator
from pydantic import Field, model_validator

from emulators.bench.faults.fault import Lasting, Problem, Stations
from emulators.bench.faults.site import BRIDGE, SECOND_BRIDGE, Site
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.table import Medium
from firmware_bridge.units import from_seconds

PROGRAMS: Final = "bridge and ground stations are other programs: start, stop and end them by the shell"


class BridgeEnds(Lasting):
    """The bridge receives a request to end, or its process is killed; at the fault's end one is started."""

    kind: ClassVar = "bridge_ends"
    bench_only: ClassVar = PROGRAMS
    among: ClassVar = Stations.NONE
    how: Annotated[Literal["interrupted", "killed"], Field(description="ended as by Ctrl-C, or killed")] = (
        "interrupted"
    )
    again_after_s: Annotated[
        float | None, Field(gt=0, le=60, description="time until a second Ctrl-C, in s")
    ] = None

    @model_validator(mode="after")
    def _a_dead_station_has_no_orders(self) -> Self:
        if self.how == "killed" and self.again_after_s is not None:
            raise ValueError("again_after_s: what was killed is not ended again")
        return self

    def targets(self, robot: AnyRobot) -> frozenset[str]:
        """Return the bridge alone."""
        del robot
        return frozenset({BRIDGE})

    def put_on(self, site: Site, chance: Generator) -> None:
        """Request its end, or kill it."""
        del chance
        if self.how == "killed":
            # Killed: what it had not wholly sent is lost, and no stop stage follows.
            site.world.detach(BRIDGE)
            return
        self._ask(site)
        if self.again_after_s is not None:
            site.world.call_at(site.world.now + from_seconds(self.again_after_s), self._ask, site)

    def take_off(self, site: Site) -> None:
        """Start a bridge: another process, which knows only what the one before has left in its file."""
        site.bridges.start()

    def _ask(self, site: Site) -> None:
        if site.world.now < self.end:
            site.bridges.end(BRIDGE)


class BridgeSuspended(Lasting):
    """The bridge's process is not run: stopped by its shell, or its laptop's lid was closed."""

    kind: ClassVar = "bridge_suspended"
    bench_only: ClassVar = PROGRAMS
    among: ClassVar = Stations.NONE

    def targets(self, robot: AnyRobot) -> frozenset[str]:
        """Return the bridge alone."""
        del robot
        return frozenset({BRIDGE})

    def put_on(self, site: Site, chance: Generator) -> None:
        """Suspend it, unless it has ended."""
        del chance
        site.bridges.suspend(BRIDGE)

    def take_off(self, site: Site) -> None:
        """Let it run on."""
        site.bridges.resume(BRIDGE)


class SecondBridge(Lasting):
    """Someone starts a second bridge on the same bus, and ends it by Ctrl-C."""

    kind: ClassVar = "second_bridge"
    bench_only: ClassVar = PROGRAMS
    among: ClassVar = Stations.NONE

    def problems(self, robot: AnyRobot) -> Iterator[Problem]:
        """Yield the equipment that this robot lacks for it."""
        if all(link.medium is not Medium.CAN for link in robot.links.values()):
            yield "kind", f"{robot.name} is on a serial line, which one program alone can open"

    def put_on(self, site: Site, chance: Generator) -> None:
        """Start it."""
        del chance
        site.bridges.start_second()

    def take_off(self, site: Site) -> None:
        """Request its end."""
        site.bridges.end(SECOND_BRIDGE)


class SecondStation(Lasting):
    """A second ground station speaks to the robot."""

    kind: ClassVar = "second_station"
    bench_only: ClassVar = PROGRAMS
    among: ClassVar = Stations.NONE
    stick: Annotated[float, Field(ge=-1, le=1, description="deflection of its stick, forward positive")] = 0.0
    order: Annotated[
        Literal["", "take", "give up", "arm", "disarm", "emergency stop", "clear", "hold", "garbage"],
        Field(description="its request, twice a second, or other data than MAVLink"),
    ] = ""
    system: Annotated[int, Field(ge=1, le=255, description="its system ID; the first station's is 255")] = 254

    def put_on(self, site: Site, chance: Generator) -> None:
        """Let it join."""
        del chance
        site.join_station(self.system, self.stick, self.order)

    def take_off(self, site: Site) -> None:
        """Let it leave without a word."""
        site.dismiss_station()
