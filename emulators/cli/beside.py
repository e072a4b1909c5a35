"""A robot's observers, as cameras, beside its emulated devices on real ports."""

from emulators.family import Beside, Devices, families_of
from firmware_bridge.robot import AnyRobot


def beside_of(robot: AnyRobot, below: Devices) -> Beside:
    """Return the observers of all families of a robot."""
    own = [one.beside(robot, below) for one in families_of(robot) if one.beside is not None]
    return Beside(
        {name: node for one in own for name, node in one.members.items()},
        {name: links for one in own for name, links in one.links.items()},
        {name: opener for one in own for name, opener in one.openers.items()},
        tuple(place for one in own for place in one.where),
    )
