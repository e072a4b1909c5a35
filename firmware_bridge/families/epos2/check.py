"""Consistency of a robot file's tables on EPOS2 drives: nodes, gateways, profiles, supply, and their pins."""

from collections.abc import Collection, Iterator
from typing import Final

from firmware_bridge.canopen_drive import check as drives
from firmware_bridge.families.epos2.settings import Epos2Device, Epos2Driver
from firmware_bridge.robot import Problem, raw
from firmware_bridge.robot.raw import Raw

NODE_IDS: Final = range(1, 128)
"""Valid node IDs; another number is reported at its own key."""


def check(table: Raw) -> Iterator[Problem]:
    """Yield the inconsistencies of a robot's drives."""
    links, axes = raw.links_of(table, Epos2Driver), raw.rows(table, "axes")
    yield from drives.check(table, links)
    for name, link in links.items():
        own = [raw.within(axis, "settings").get("node") for axis in axes if axis.get("link") == name]
        yield from _watched(name, link, [node for node in own if isinstance(node, int)])
    yield from _supplied(table, [axis for axis in axes if axis.get("link") in links])


def _watched(name: str, link: Raw, nodes: Collection[int]) -> Iterator[Problem]:
    gateway = link.get("gateway")
    if link.get("driver") == Epos2Driver.SERIAL and gateway in NODE_IDS and nodes:
        # The gateway does not receive its own frames, so it can only watch another drive of the bus.
        if gateway not in nodes:
            yield Problem(f"links.{name}.gateway", f"{gateway} is not the node of an axis on this link")
        elif len(nodes) == 1:
            yield Problem(f"links.{name}.gateway", "a drive without another one behind it watches no one")


def _supplied(table: Raw, axes: list[Raw]) -> Iterator[Problem]:
    """Check that each drive takes the battery's voltage."""
    nominal = raw.within(table, "battery").get("nominal_v")
    types = {one.value: one.supply_v for one in Epos2Device}
    for axis in axes:
        device = raw.within(axis, "settings").get("device")
        most = types.get(device) if isinstance(device, str) else None
        if most is not None and isinstance(nominal, int | float) and nominal > most:
            problem = f"{nominal:g} V: the EPOS2 {device} of '{axis.get('name')}' takes {most} V at most"
            yield Problem("battery.nominal_v", problem)
            return
