"""Values of a bench, and of devices that `emulate` runs, for a plotter.

`firmware_bridge.live.plotted` sends them, and has those of a bridge on a real robot.
"""

from collections.abc import Callable
from contextlib import suppress
from typing import Final

from emulators.canopen.slave import CanopenSlave
from emulators.control.live import Live
from emulators.rig import Rig
from firmware_bridge.canopen import objects as od
from firmware_bridge.live.plotted import TIME, known, values_of
from firmware_bridge.live.state import Json, bridge_state, number
from firmware_bridge.units import Nanoseconds, to_seconds
from fmu.errors import PlantError

OBJECTS: Final = {
    "statusword": od.STATUSWORD,
    "mode": od.MODE_DISPLAY,
    "position": od.POSITION_ACTUAL,
    "velocity": od.VELOCITY_ACTUAL,
    "current": od.CURRENT_ACTUAL,
}
"""Objects of an emulated drive, in its own units."""


def of_rig(rig: Rig) -> Callable[[Nanoseconds], Json]:
    """Return what reads a bench: its bridge, and the newest sample of the plant."""

    def read(_now: Nanoseconds) -> Json:
        samples = rig.samples
        newest = samples[-1] if len(samples) else None
        return values_of(
            {
                **bridge_state(rig.robot, rig.bridge),
                "at_s": to_seconds(rig.world.now),
                "measured": {}
                if newest is None
                else {column.name: number(newest[column.name]) for column in samples.columns},
                "buses": [
                    {"name": name, "load_percent": number(wire.load_percent())}
                    for name, wire in rig.can_wires.items()
                ],
            }
        )

    return read


def of_devices(live: Live) -> Callable[[Nanoseconds], Json]:
    """Return what reads emulated devices: objects of their drives, and the outputs of the plant."""
    slaves = live.devices.nodes(CanopenSlave)
    plant = live.plant
    outputs = (
        ()
        if plant is None
        else tuple(one.name for one in plant.variables.values() if one.causality == "output")
    )

    def read(_now: Nanoseconds) -> Json:
        drives = {
            name: {
                title: slave.store.live(address)
                for title, address in OBJECTS.items()
                if address in slave.store.objects
            }
            for name, slave in slaves.items()
        }
        values: Json = {TIME: to_seconds(live.carrier.now), "drives": drives}
        # A plant that has failed ends the run elsewhere, with its own message.
        with suppress(PlantError):
            values["plant"] = {name: number(plant.read(name)) for name in outputs} if plant else {}
        return known(values)

    return read
