"""Emulated devices on real buses and lines, on the live page: shown, with faults, inputs and restarts."""

from collections.abc import Iterable
from typing import Final

from emulators.canopen.slave import CanopenSlave
from emulators.control.desk import Desk
from emulators.control.live import Live
from emulators.family import Way
from emulators.live.hello import faults
from emulators.live.on_desk import OF_DESK, desk_does
from emulators.live.plot_values import of_devices
from firmware_bridge.canopen.cia402 import STATES
from firmware_bridge.dissector.bus_picture import BusPicture
from firmware_bridge.explain.explainer import BusExplainer, Setup
from firmware_bridge.live.bus import LiveBus, known, news
from firmware_bridge.live.messages import VERSION
from firmware_bridge.live.page_node import PageError, PageNode
from firmware_bridge.live.state import Json, axes_of
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds, to_seconds

MILLI: Final = 1000.0


class LiveDevices(PageNode):
    """A node around the control desk of emulated devices."""

    def __init__(self, desk: Desk, live: Live, bit_rate: int | None = None) -> None:
        """Take the desk, the devices, and their buses' bit rate where it is not the robot file's."""
        super().__init__(desk)
        self._live: Final = live
        self._values: Final = of_devices(live)
        self._buses: Final = {
            link: LiveBus(BusPicture(rate), BusExplainer(Setup(bit_rate=rate)), link)
            for link, rate in _buses(live, bit_rate).items()
        }

    def report(self, text: str) -> None:
        """Show what the desk has done among the events."""
        self.event(text, "warning", self._live.carrier.now)

    def _received(self, packet: Packet, now: Nanoseconds) -> None:
        self._seen(packet, now)

    def _leaves(self, packet: Packet, now: Nanoseconds) -> bool:
        self._seen(packet, now)
        return True

    def _seen(self, packet: Packet, now: Nanoseconds) -> None:
        bus = self._buses.get(packet.link)
        if bus is not None:
            bus.picture.note(now, packet)
            bus.take(now, packet)

    def _hello(self) -> Json:
        return {
            "kind": "hello",
            "version": VERSION,
            "title": f"{self._live.robot.name}, emulated",
            "mode": "devices",
            "axes": axes_of(self._live.robot),
            "outline": [],
            "faults": list(faults(self._live.robot, self._live.out_of_reach)),
            "can": [*OF_DESK, "watch_frames"],
        }

    def _state(self, now: Nanoseconds) -> Json:
        del now
        records = self._live.faults
        values = self._values(0)
        return {
            "kind": "state",
            "at_s": to_seconds(self._live.carrier.now),
            "paused": False,
            "speed": 1.0,
            "measured": values.get("plant", {}),
            "axes": list(self._axes(values.get("drives", {}))),
            "buses": [one for bus in self._buses.values() for one in bus.state()["buses"]],
            "faults": [
                {"number": one, "kind": it.kind, "nodes": list(it.nodes), "began_s": to_seconds(it.began)}
                for one in records.standing
                for it in (records.record_of(one),)
            ],
        }

    def _axes(self, values: Json) -> Iterable[Json]:
        """Yield each drive by its own objects; motors without a dictionary show whether they have power."""
        motors = {motor.name: motor for motor in self._live.devices.axes}
        slaves = self._live.devices.nodes(CanopenSlave)
        for axis in self._live.robot.axes:
            name, motor, slave = axis.name, motors.get(axis.name), slaves.get(axis.name)
            known = values.get(name, {})
            current, here = known.get("current"), slave is None or self._live.carrier.here(name)
            yield {
                "name": name,
                "power": "unknown" if motor is None else "on" if motor.powered else "off",
                "state": _text(known.get("statusword")),
                "position": known.get("position"),
                "velocity": known.get("velocity"),
                "target": None,
                "current_a": None if current is None else current / MILLI,
                "temperature_c": None,
                "fault": "" if here else "without supply",
            }

    def _known(self) -> Iterable[Json]:
        return (known(self._buses.values()),)

    def _news(self, now: Nanoseconds) -> Iterable[Json]:
        del now
        yield from news(self._buses.values())

    def _do(self, name: str, request: Json, now: Nanoseconds) -> tuple[Reaction, Json]:
        if name == "watch_frames":
            for bus in self._buses.values():
                bus.watch(request)
            return self._node.wake(now), {}
        if name not in OF_DESK:
            raise PageError(f"'{name:.40}': there are {', '.join(OF_DESK)}")
        return desk_does(self._node, request, now)


def _buses(live: Live, bit_rate: int | None) -> dict[str, int]:
    """Return the bit rate of each bus by the name that it has outside."""
    return {
        live.carrier.links(name).get(own, own): bit_rate or live.robot.links[one.link].rate
        for name, one in live.devices.stations.items()
        for own, way in one.on.items()
        if way is Way.BUS and live.carrier.here(name)
    }


def _text(statusword: int | None) -> str:
    if statusword is None:
        return ""
    state = STATES.state_of(statusword)
    return f"0x{statusword:04X} {'no state' if state is None else state.title}"
