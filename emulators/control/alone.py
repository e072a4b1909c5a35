"""Devices that `emulate` runs without a robot: what faults need to know of them."""

from collections.abc import Mapping, Sequence
from typing import Final, cast

from emulators.control.live import Live, on_real_links
from emulators.family import Devices, Station
from emulators.gateway import Cluster
from emulators.physics import Motor, Physics
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds
from fmu.plant import FmuPlant


def stand_in(like: tuple[str, str], title: str, link: str, numbers: Mapping[str, int]) -> AnyRobot:
    """Return a robot with axes of these names and numbers, and nothing else that a fault reads of one.

    `like` is an installed robot whose first axis has such a device, and the key of its number.
    """
    name, key = like
    robot = find(name)
    pattern = robot.axes[0]
    axes = tuple(
        pattern.model_copy(
            update={"name": axis, "link": link, "settings": pattern.settings.model_copy(update={key: number})}
        )
        for axis, number in numbers.items()
    )
    links = {link: robot.links[pattern.link]}
    return robot.model_copy(update={"name": title, "axes": axes, "links": links, "battery": None})


class _Found:
    """Motors by their names."""

    def __init__(self, motors: Sequence[Motor]) -> None:
        self.axes: Final = tuple(motors)

    def advance(self, until: Nanoseconds) -> tuple[Nanoseconds, tuple[str, ...]]:
        """Move nothing."""
        return until, ()


def alone(
    robot: AnyRobot,
    stations: Mapping[str, Station],
    motors: Sequence[Motor],
    cluster: Cluster,
    plant: object = None,
    *,
    on_ptys: bool = False,
) -> Live:
    """Return devices with their motors, and the plant below where that is an FMU."""
    fmu = plant if isinstance(plant, FmuPlant) else None
    # The cluster moves them; here they are only found.
    physics = Physics(_Found(motors), (), MILLISECOND)
    # Only a fault of the plant itself needs it, and this robot has none.
    devices = Devices(stations, physics, cast("FmuPlant", fmu), physics)
    return on_real_links(robot, devices, cluster, fmu, on_ptys=on_ptys)
