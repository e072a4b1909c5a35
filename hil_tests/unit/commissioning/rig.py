"""Two drives with motors, the first with a serial port, and an engineer's client on one way or another."""

from collections.abc import Callable
from dataclasses import dataclass

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.single import DrivesOrder, drives
from emulators.servo.motor import SUPPLY_MV
from emulators.wires import CanWire, SerialWire, usb_line
from emulators.world import World
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import Ask, JobClient, Script, need
from firmware_bridge.families.epos2.commissioning.job import Job, Outcome
from firmware_bridge.families.epos2.commissioning.serial_access import SerialAccess
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

NEAR = 1
FAR = 2


@dataclass(frozen=True)
class Way:
    """Link by which the client reaches a drive."""

    name: str
    node: int
    generation: Generation | None = None

    def __str__(self) -> str:
        return self.name

    def link(self) -> CanAccess | SerialAccess:
        return CanAccess(self.node) if self.generation is None else SerialAccess(self.generation, self.node)


BUS = Way("can", NEAR)
OWN_LINE = Way("v1", 0, Generation.V1)
USB = Way("v2", 0, Generation.V2)
WAYS = (
    BUS,
    OWN_LINE,
    USB,
    Way("v1 by number", NEAR, Generation.V1),
    Way("v1 gateway", FAR, Generation.V1),
    Way("v2 gateway", FAR, Generation.V2),
)


class Rig:
    """The drives are on from the start; a client comes, does its work, and goes."""

    def __init__(self, generation: Generation | None = None, supply_mv: int = SUPPLY_MV) -> None:
        order = DrivesOrder(
            (NEAR, FAR),
            PROFILES["70/10"],
            1_000_000,
            serial={NEAR: generation or Generation.V1},
            supply_mv=supply_mv,
        )
        made, self.bank = drives(order)
        self.drives = {NEAR: made["motor1"], FAR: made["motor2"]}
        self.world = World(self.bank)
        self.bus = CanWire(1_000_000)
        self.line = usb_line("client") if generation is Generation.V2 else SerialWire(115_200)
        self.world.attach("motor1", self.drives[NEAR], {CAN: self.bus, SERIAL: self.line})
        self.world.attach("motor2", self.drives[FAR], {CAN: self.bus})
        self.waits(20 * MILLISECOND)

    def waits(self, duration: Nanoseconds) -> None:
        self.world.run(self.world.now + duration)

    def does(
        self, link: CanAccess | SerialAccess, script: Script, within: Nanoseconds = 20 * SECOND
    ) -> JobClient:
        """Carry a script out, and raise what it failed with."""
        client = JobClient(link, script)
        wire = {CAN: self.bus} if isinstance(link, CanAccess) else {SERIAL: self.line}
        self.world.attach("client", client, wire)
        end = self.world.now + within
        while not client.finished and self.world.now < end:
            self.waits(MILLISECOND)
        self.waits(2 * MILLISECOND)  # a last byte is still on its way
        self.world.detach("client")
        if client.failure is not None:
            raise client.failure
        assert client.finished, f"not finished within {within} ns"
        return client

    def tries(self, link: CanAccess | SerialAccess, job: Job) -> Outcome:
        """Do one job, and return how it ended."""
        ended: list[Outcome] = []
        self.does(link, (Ask(job, noting(ended)),))
        return ended[0]

    def value(self, node: int, address: Address) -> int | bytes:
        return self.drives[node or NEAR].store.get(address)


def rig_for(way: Way) -> Rig:
    return Rig(way.generation)


def noting(ended: list[Outcome]) -> Callable[[Outcome], Script]:
    def note(outcome: Outcome) -> Script:
        ended.append(outcome)
        return ()

    return note


__all__ = ["BUS", "FAR", "NEAR", "OWN_LINE", "USB", "WAYS", "Rig", "Way", "need", "noting", "rig_for"]
