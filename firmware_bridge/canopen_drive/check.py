"""Consistency of a robot file on CiA 402 drives: nodes, times, profiles, and what is at their pins."""

from collections.abc import Collection, Iterator, Mapping
from typing import Final

from firmware_bridge.robot import Problem, raw
from firmware_bridge.robot.problems import near
from firmware_bridge.robot.raw import Raw
from firmware_bridge.units import RPM_PER_RAD_S

ROUNDING: Final = 1e-12
"""Share of a speed by which its conversion may fall short, as the guard has it."""
BY_SAMPLES: Final = ("ramp", "quick_stop", "power_off", "silence")
"""The stop stages that a drive confirms by its reports of every cycle."""


def check(table: Raw, links: Mapping[str, Raw]) -> Iterator[Problem]:
    """Yield the inconsistencies of the drives on these links; doubled names are reported elsewhere."""
    axes = raw.rows(table, "axes")
    own = {index: axis for index, axis in enumerate(axes) if axis.get("link") in links}
    yield from _profiles(own)
    for name, link in links.items():
        yield from _numbered(name, link, {index: axis for index, axis in own.items() if axis["link"] == name})
        yield from _in_time(name, link, table.get("cycle_ms"))
    names = [axis.get("name") for axis in axes]
    if all(isinstance(name, str) and names.count(name) == 1 for name in names):
        for key in ("sensors", "outputs"):
            yield from _at_drives(key, raw.rows(table, key), axes, links)


def _profiles(axes: Mapping[int, Raw]) -> Iterator[Problem]:
    """Check that no profile is faster than the guard lets through: its drive could not be set up."""
    for index, axis in axes.items():
        profile = raw.within(raw.within(axis, "settings"), "profile")
        if axis.get("command") == "position":
            bound = "top_speed"
            rpm = raw.number(axis.get("top_speed")) * raw.number(axis.get("ratio")) * RPM_PER_RAD_S
        else:
            bound, rpm = "max_velocity_rpm", raw.number(profile.get("max_velocity_rpm"))
        velocity = raw.number(profile.get("velocity_rpm"))
        # Every comparison with NaN is false: a value that is missing here is reported elsewhere.
        if velocity > rpm * (1.0 + ROUNDING):
            key = f"axes[{index}].settings.profile.velocity_rpm"
            yield Problem(key, f"{velocity:.10g} is above {bound}, which is {rpm:.5g} rpm of the motor")


def _numbered(name: str, link: Raw, axes: Mapping[int, Raw]) -> Iterator[Problem]:
    """Check one link: no node twice, and none the bridge's own."""
    nodes: dict[int, int] = {}
    for index, axis in axes.items():
        node = raw.within(axis, "settings").get("node")
        key = f"axes[{index}].settings.node"
        if not isinstance(node, int):
            continue
        if node in nodes:
            yield Problem(key, f"{node} is the node of axes[{nodes[node]}], too")
        # The bridge's heartbeat would be taken for that drive's, and the other way round.
        elif node == link.get("bridge_node"):
            yield Problem(key, f"{node} is the bridge's own node, links.{name}.bridge_node")
        nodes.setdefault(node, index)


def _in_time(name: str, link: Raw, cycle_ms: object) -> Iterator[Problem]:
    every = link.get("every", 1)
    if not (isinstance(cycle_ms, int) and isinstance(every, int)):
        return
    for step, time_ms in raw.within(link, "stop_confirmed_ms").items():
        # One sample may have been requested just before, and the next one may be lost.
        if isinstance(time_ms, int) and step in BY_SAMPLES and time_ms <= 2 * every * cycle_ms:
            problem = f"{time_ms} is not longer than two of the link's cycles, {2 * every * cycle_ms}"
            yield Problem(f"links.{name}.stop_confirmed_ms.{step}", problem)


def _at_drives(key: str, rows: list[Raw], axes: list[Raw], links: Collection[str]) -> Iterator[Problem]:
    """Check that each row is at the drive of an axis on its own link, and alone at its pin."""
    found = {str(axis.get("name")): axis.get("link") for axis in axes}
    pins: dict[tuple[object, int], int] = {}
    for index, row in enumerate(rows):
        # A row on a link of another family is that family's to check.
        if row.get("link") not in links:
            continue
        settings = raw.within(row, "settings")
        axis, output = settings.get("axis"), settings.get("output")
        if not isinstance(axis, str):
            continue
        link = found.get(axis)
        if axis not in found:
            yield Problem(f"{key}[{index}].settings.axis", f"no axis '{axis}'; {near(axis, found)}")
        # One chained comparison: not the row's own link, and that link exists.
        elif isinstance(link, str) and link in links and link != row.get("link") in links:
            yield Problem(f"{key}[{index}].link", f"the axis '{axis}' is on the link '{link}'")
        if isinstance(output, int):
            first = pins.setdefault((axis, output), index)
            if first != index:
                yield Problem(f"{key}[{index}].settings.output", f"{output} is that of {key}[{first}], too")
