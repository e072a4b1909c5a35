"""One robot put together: operator, bridge, links, drives and plant in the virtual world."""

from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from emulators.bench import margin
from emulators.bench.bench_setup import BenchSetup
from emulators.bench.columns import SAMPLE_EVERY, Column, Samples, columns_of, electric
from emulators.bench.faults import BRIDGE, OPERATOR_STATION, SECOND_BRIDGE, Fault, Faults, Site
from emulators.bench.injected import InjectedFaults
from emulators.bench.mission import Noise
from emulators.bench.records import InterlockLog
from emulators.bench.second_station import SecondStation
from emulators.devices import devices
from emulators.family import Line, LinkWires, family_of
from emulators.rewind import Checkpoint, Rewind
from emulators.wires import DatagramWire, FaultyCanWire
from emulators.wires.adapter import Adapter
from emulators.world import Wire, World
from firmware_bridge.bridge import Bridge
from firmware_bridge.intent import ConfirmPosition
from firmware_bridge.node import CAN, OPERATOR, Node
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import robot_type_of
from firmware_bridge.safety.guard import guarded
from firmware_bridge.slow_link.conditions import Conditions
from firmware_bridge.slow_link.node import before_operator
from firmware_bridge.units import MILLISECOND, Nanoseconds, from_seconds

LINK_STREAM: Final = 1
"""Stream of random numbers for the operator's link, beside the run's seed."""
DIRECTIONS_STREAM: Final = 2
"""First stream of the slow link's directions."""
QUIET: Final = Noise()
GOOD: Final = Conditions()
__all__ = ["BRIDGE", "OPERATOR_STATION", "QUIET", "SECOND_BRIDGE", "Rig"]


class Rig:
    """A robot on the bench: `run` moves time on; the results are in `samples` and `holds`.

    The operator's link delays, jitters and loses by `noise` and `link`, with the run's seed. `confirmed`: the
    axis positions that the bridge receives at its start. `injects` allows the station in control to inject
    failures, of the devices, too.
    """

    def __init__(
        self,
        robot: AnyRobot,
        bench_setup: BenchSetup,
        operator: Node,
        *,
        plant_path: Path | None = None,
        seed: int = 0,
        noise: Noise = QUIET,
        link: Conditions = GOOD,
        realistic_latency: bool = False,
        faults: Sequence[Fault] = (),
        confirmed: tuple[ConfirmPosition, ...] = (),
        injects: bool = False,
    ) -> None:
        self.robot: Final = robot
        self._injects: Final = injects
        columns = (*columns_of(electric(robot), bench_setup.columns), *margin.columns(robot))
        outputs = [column.plant for column in columns if column.plant]
        self.devices: Final = devices(
            robot,
            plant_path,
            outputs=outputs,
            seed=seed,
            realistic_latency=realistic_latency,
            on_bench=True,
        )
        plant = self.devices.plant
        self._reads: Final = _reads(columns, (*plant.output_names, *plant.shown_names))
        self._start_bridge(confirmed)
        families = {name: family_of(robot, name) for name in robot.links}
        buses = {name: bus for name, one in families.items() if (bus := one.bus(robot, name))}
        self.can_wires: Final = {
            name: FaultyCanWire(bus.bit_rate, CAN if len(buses) == 1 else name) for name, bus in buses.items()
        }
        """The CAN buses by the links' names."""
        self.operator_wire: Final = DatagramWire(
            round(noise.delay_ms * MILLISECOND),
            round(noise.jitter_ms * MILLISECOND),
            noise.loss,
            # A stream of its own: noise on this link shifts no other random number.
            np.random.default_rng([seed, LINK_STREAM]),
        )
        self.datagram_wires: Final = {
            name: DatagramWire(name=name) for name, one in families.items() if one.datagrams
        }
        """The datagrams of those links that carry such, by the links' names."""
        self.world: Final = World(self.devices.physics)
        self.lines: Final[dict[str, Line]] = {}
        """The serial lines by the links' names."""
        self._link: Final = link
        self._seed: Final = seed
        self._attach(_far(operator, link, seed))
        self._site: Final = self._as_site()
        self.faults: Final = Faults(self._site, seed)
        self._injected: Final = InjectedFaults(robot, self.faults) if injects else None
        self.bridge.operator.injection.devices = self._injected
        self.faults.plan(faults)
        self.samples: Final = Samples(columns)
        self._holds: Final = InterlockLog(self.bridge.interlock_events)
        self.interlock_events: Final = self._holds.records
        self._next_sample: Nanoseconds = 0
        self._rewind = Rewind(self)

    @property
    def can_wire(self) -> FaultyCanWire:
        """The drives' bus of a robot that has one."""
        return next(iter(self.can_wires.values()))

    @property
    def line(self) -> Line | None:
        """The serial line of a robot that has one."""
        return next(iter(self.lines.values()), None)

    def run(self, until: Nanoseconds) -> None:
        """Let everything happen up to `until`, and take a sample every 10 ms."""
        while self._next_sample <= until:
            # The plant has to be exactly at the sample's instant.
            self.world.run(self._next_sample)
            self._sample(self._next_sample)
            self._next_sample += SAMPLE_EVERY
        self.world.run(until)

    def runs(self, seconds: float) -> None:
        """Run on for some seconds."""
        self.run(self.world.now + from_seconds(seconds))

    def snapshot(self) -> Checkpoint:
        """Keep this instant of the world, with what was sampled so far; see `World.snapshot`."""
        return self._rewind.snapshot()

    def restore(self, moment: Checkpoint) -> None:
        """Go to an instant that this rig has kept."""
        self._rewind.restore(moment)

    def finish(self) -> None:
        """Let go of the plant."""
        self.devices.plant.close()

    @property
    def stations(self) -> Sequence[SecondStation]:
        """The ground stations beside the operator's that have joined."""
        return self._site.stations

    @property
    def adapters(self) -> Sequence[Adapter]:
        """Adapters of the newest bridge at its ends of the serial lines."""
        return [line.adapter for line in self.lines.values()]

    def start(self) -> None:
        """Start a bridge in the place of the one that was, which is killed where it still runs."""
        if self.world.here(BRIDGE):
            self.world.detach(BRIDGE)
        # As the runtime does from its file: the new process is offered the last positions.
        places = self.bridge.places
        self._start_bridge()
        self.bridge.operator.injection.devices = self._injected
        self.bridge.offer(places)
        self._attach_bridge(self._lines())

    def start_second(self) -> None:
        """Start a second bridge on the buses; no one is at its operator's link, and no cameras serve it."""
        if self.world.here(SECOND_BRIDGE):
            self.world.detach(SECOND_BRIDGE)
        # Its own bridge from the same robot file: both are masters with the same node number.
        second = guarded(Bridge(self.robot, robot_type_of(self.robot)), self.robot)
        alone = {name: DatagramWire(name=f"second {name}") for name in (*self.datagram_wires, OPERATOR)}
        self.world.attach(SECOND_BRIDGE, second, {**self.can_wires, **alone})

    def end(self, name: str) -> None:
        """Request a bridge to end in good order."""
        self.world.stop(name)

    def suspend(self, name: str) -> None:
        """Let a bridge not run, if it has not ended."""
        if self.world.here(name):
            self.world.suspend(name)

    def resume(self, name: str) -> None:
        """Let it run again."""
        if self.world.here(name):
            self.world.resume(name)

    def _start_bridge(self, confirmed: tuple[ConfirmPosition, ...] = ()) -> None:
        self.bridge = Bridge(
            self.robot, robot_type_of(self.robot), confirmed=confirmed, injects=self._injects
        )
        self.guard = guarded(self.bridge, self.robot)

    def _lines(self) -> Node:
        """Put the bridge behind its serial lines; return what is on the wires for it."""
        node: Node = self.guard
        for link_drivers in self.bridge.all_drivers.all:
            name = link_drivers.name
            make = family_of(self.robot, name).line
            before = self.lines.get(name)
            line = None if make is None else make(self.robot, node, link_drivers.link, BRIDGE, before)
            if line is not None:
                self.lines[name] = line
                node = line.adapter
        return node

    def hand_over_to(self, operator: Node) -> None:
        """Let another operator sit at the station from now on."""
        self.world.detach(OPERATOR_STATION)
        far = _far(operator, self._link, self._seed)
        self.world.attach(OPERATOR_STATION, far, {OPERATOR: self.operator_wire})

    def _attach_bridge(self, node: Node) -> None:
        lines = {name: line.wire for name, line in self.lines.items()}
        wires: dict[str, Wire] = {**self.can_wires, **lines, **self.datagram_wires}
        self.world.attach(BRIDGE, node, {**wires, OPERATOR: self.operator_wire})

    def _attach(self, operator: Node) -> None:
        """Attach all to their wires: the devices, the bridge behind its lines, and the operator."""
        node = self._lines()
        wires = LinkWires(self.can_wires, self.lines, self.datagram_wires)
        for name, station in self.devices.stations.items():
            self.world.attach(name, station.node, wires.of(station))
        self._attach_bridge(node)
        self.world.attach(OPERATOR_STATION, operator, {OPERATOR: self.operator_wire})

    def _as_site(self) -> Site:
        """Return where faults are put on."""
        return Site(
            self.robot,
            self.world,
            self.can_wires,
            self.operator_wire,
            devices=self.devices,
            bridges=self,
            datagram_wires=self.datagram_wires,
            lines={name: line.wire for name, line in self.lines.items()},
        )

    def _sample(self, now: Nanoseconds) -> None:
        plant, seen = self.devices.plant, self.bridge.seen
        outputs = (*plant.outputs[:], *plant.look())
        values = [
            outputs[place] if column.seen is None else column.seen(seen) for column, place in self._reads
        ]
        self.samples.add(now, tuple(values))
        self._holds.note(self.bridge.interlock_events, now)


def _far(operator: Node, link: Conditions, seed: int) -> Node:
    """Return the operator behind a slow link; as he is, where the link is good."""
    if link == GOOD:
        return operator
    up, down = (np.random.default_rng([seed, DIRECTIONS_STREAM, direction]) for direction in range(2))
    return before_operator(operator, OPERATOR, link, up, down)


def _reads(columns: tuple[Column, ...], outputs: Sequence[str]) -> tuple[tuple[Column, int], ...]:
    """Return each column with the place of its output in the plant's."""
    return tuple((column, outputs.index(column.plant) if column.plant else 0) for column in columns)
