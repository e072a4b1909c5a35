"""A robot's drivers behind the guard, with emulated drives: start-up by stages, then the cycles."""

from collections.abc import Mapping
from typing import Final

from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.single import DrivesOrder, drives
from emulators.wires import CanWire, SerialWire
from emulators.world import Wire, World
from firmware_bridge.drivers.all_drivers import all_drivers_of
from firmware_bridge.drivers.driver import Feedback, Level, Reading, SetPoint
from firmware_bridge.drivers.life_cycle import AT_REST, START_UP, DriverState, Task, Transition
from firmware_bridge.families.epos2.driver.serial.line import MaxonLine
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Driver, Epos2Link
from firmware_bridge.node import CAN, SERIAL, Node
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.safety.guard import guarded
from firmware_bridge.units import NEVER, Nanoseconds, from_seconds

HOST: Final = "host"


class Host:
    """Commands drivers as a bridge does, and judges nothing; a `firmware_bridge.node.Node`."""

    def __init__(self, robot: AnyRobot) -> None:
        self.all_drivers: Final = {link_drivers.name: link_drivers for link_drivers in all_drivers_of(robot)}
        self.drivers: Final = [
            driver for link_drivers in self.all_drivers.values() for driver in link_drivers.drivers
        ]
        self.set_points: dict[str, SetPoint] = {}
        self.levels: dict[str, Level] = {}
        self.running = False
        self.repairs = True
        """True if a drive that has lost its set-up is brought up again."""
        self._cycle = robot.cycle
        self._cycle_at: Nanoseconds = 0
        self._release_at: Nanoseconds = NEVER
        self._beats = dict.fromkeys(self.all_drivers, 0)
        self._start = list(START_UP)
        self._task: Task | None = None

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        return self._reaction(self.all_drivers[packet.link].link.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        sent: tuple[Packet, ...] = ()
        for link_drivers in self.all_drivers.values():
            sent += link_drivers.wake(now)
            if now >= self._beats[link_drivers.name]:
                self._beats[link_drivers.name] = now + link_drivers.link.beat_every
                sent += link_drivers.link.beat(now)
        if now >= self._cycle_at:
            self._cycle_at += self._cycle
            sent += self._begin_cycle(now)
        if now >= self._release_at:
            self._release_at = NEVER
            for link_drivers in self.all_drivers.values():
                sent += link_drivers.release()
        return self._reaction(sent, now)

    def _begin_cycle(self, now: Nanoseconds) -> tuple[Packet, ...]:
        sent: tuple[Packet, ...] = ()
        for link_drivers in self.all_drivers.values():
            if self.running or self._task in (Task.START, Task.ENABLE):
                sent += link_drivers.link.sample(now)
            for driver in link_drivers.drivers if self.running and self.repairs else ():
                if driver.state in (DriverState.UNCONFIGURED, DriverState.FAILED):
                    sent += driver.begin(Transition.RECOVER, now)
            if self.running:
                sent += (
                    link_drivers.measure(now)
                    + link_drivers.command(self.set_points)
                    + link_drivers.switch(self.levels, now)
                )
                self._release_at = now + self._cycle // 2
        return sent

    def _reaction(self, sent: tuple[Packet, ...], now: Nanoseconds) -> Reaction:
        if not self.running and not any(driver.state not in AT_REST for driver in self.drivers):
            failures = [driver.failure for driver in self.drivers if driver.failure is not None]
            assert not failures, failures
            if self._start:
                transition, self._task = self._start.pop(0)
                for driver in self.drivers:
                    sent += driver.begin(transition, now, self._task)
            else:
                self.running = True
        wake_at = min([self._cycle_at, self._release_at, *self._beats.values()])
        return Reaction(
            sent, min([wake_at, *(link_drivers.wake_at for link_drivers in self.all_drivers.values())])
        )


class Bench:
    """One emulated drive for each axis of the robot, with a motor of its own, on the axis's link."""

    def __init__(self, robot: AnyRobot, *, guarding: bool = True, host: type[Host] = Host) -> None:
        names = [axis.name for axis in robot.axes]
        gateways = {
            Epos2Axis.of(axis).node: Epos2Link.of_link(robot, axis.link).protocol
            for axis in robot.axes
            if Epos2Link.of_link(robot, axis.link).driver is Epos2Driver.SERIAL
            and Epos2Link.of_link(robot, axis.link).gateway == Epos2Axis.of(axis).node
        }
        nodes = [Epos2Axis.of(axis).node for axis in robot.axes]
        order = DrivesOrder(nodes, PROFILES["70/10"], 1_000_000, axes=names, serial=gateways)
        made, bank = drives(order)
        self.drives: Final = made
        self.axes: Final = {axis.name: axis for axis in bank.axes}
        self.world: Final = World(bank)
        self.host: Final = host(robot)
        self.buses: Final = {
            name: CanWire(link.bit_rate, name) for name, link in Epos2Link.all_of(robot).items()
        }
        self.guard: Final = guarded(self.host, robot)
        node: Node = self.guard if guarding else self.host
        wires: dict[str, Wire] = {}
        for name, link in Epos2Link.all_of(robot).items():
            if link.driver is Epos2Driver.SERIAL:
                wires[name] = SerialWire(link.line_rate, name=f"{name} line")
                node = MaxonLine(node, link.protocol, name)
            else:
                wires[name] = self.buses[name]
        for axis in robot.axes:
            links: dict[str, Wire] = {CAN: self.buses[axis.link]}
            if (
                Epos2Link.of_link(robot, axis.link).driver is Epos2Driver.SERIAL
                and Epos2Axis.of(axis).node in gateways
            ):
                links[SERIAL] = wires[axis.link]
            self.world.attach(axis.name, self.drives[axis.name], links)
        self.world.attach(HOST, node, wires)

    def runs(self, seconds: float) -> None:
        """Let time pass."""
        self.world.run(self.world.now + from_seconds(seconds))

    def starts(self) -> None:
        """Bring all drives up."""
        for _ in range(40):
            self.runs(0.25)
            if self.host.running:
                return
        raise AssertionError("the drives did not come up within 10 s")

    def feedback(self, axis: str) -> Feedback:
        found = [
            driver.feedback
            for link_drivers in self.host.all_drivers.values()
            for driver in link_drivers.drivers
            if driver.axis.name == axis
        ]
        return found[0]

    def readings(self) -> Mapping[str, Reading]:
        known: dict[str, Reading] = {}
        for link_drivers in self.host.all_drivers.values():
            known |= link_drivers.readings(self.world.now)
        return known
