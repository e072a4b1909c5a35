"""Consistency of a robot file's tables: names that exist, once each; links that carry.

The check reads the raw tables, so that these mistakes are reported together with those of single keys.
"""

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Final, TypeAlias

from firmware_bridge.robot.problems import Problem, near, nearest
from firmware_bridge.robot.settings.capture import CaptureDriver
from firmware_bridge.robot.settings.epos2 import Epos2Device
from firmware_bridge.units import RPM_PER_RAD_S

Raw: TypeAlias = Mapping[str, object]
SERIAL: Final = "epos2-serial"
NODE_IDS: Final = range(1, 128)
"""Valid node IDs; another number is reported at its own key."""
ROUNDING: Final = 1e-12
"""Share of a speed by which its conversion may fall short, as the guard has it."""
BY_SAMPLES: Final = ("ramp", "quick_stop", "power_off", "silence")
"""The stop stages that a drive confirms by its reports of every cycle."""


def cross_checked(table: Raw, roles: Mapping[str, str]) -> Iterator[Problem]:
    """Yield the inconsistencies; `roles` are those of the robot type, with their group.

    One mistake is one problem: a reference to an axis or a link is judged only where their own names are
    valid.
    """
    axes, sensors, outputs = (_tables(table, key) for key in ("axes", "sensors", "outputs"))
    links = _named(table, "links")
    for key, rows in (("axes", axes), ("sensors", sensors), ("outputs", outputs)):
        yield from _once(rows, key, "name")
        if links and len(links) == len(_within(table, "links")):
            yield from _linked(key, rows, links)
    if isinstance(table.get("axes"), list):
        yield from _roles(axes, roles)
    yield from _profiles(axes)
    for name, link in links.items():
        yield from _carried(name, link, axes, sensors)
        yield from _in_time(name, link, table.get("cycle_ms"))
        yield from _stopping(name, link, axes, roles)
    yield from _battery(table, sensors)
    yield from _supplied(table, axes)
    yield from _captured(axes, sensors, links)
    names = [axis.get("name") for axis in axes]
    # Other tables refer to axes by name: a missing or doubled one is reported already, and would be so again.
    if all(isinstance(name, str) and names.count(name) == 1 for name in names):
        for key, rows in (("sensors", sensors), ("outputs", outputs)):
            yield from _at_drives(key, rows, axes, links)
        yield from _guarded(table, axes)
        yield from _homed(axes)


def _homed(axes: list[Raw]) -> Iterator[Problem]:
    """Check that the axes that are homed before another one exist, and that some order is possible."""
    before = {str(axis.get("name")): _after(axis) for axis in axes}
    for index, (name, first) in enumerate(before.items()):
        key = f"axes[{index}].zero.homing.after"
        for other in first:
            if other not in before:
                yield Problem(key, f"no axis '{other}'; {near(other, before)}")
            elif name == other or name in before[other]:
                yield Problem(key, f"'{name}' would wait for '{other}', which waits for it")


def _after(axis: Raw) -> list[str]:
    first = _within(_within(axis, "zero"), "homing").get("after")
    return [name for name in first if isinstance(name, str)] if isinstance(first, list) else []


def _linked(key: str, rows: list[Raw], links: Collection[str]) -> Iterator[Problem]:
    for index, row in enumerate(rows):
        link = row.get("link")
        if isinstance(link, str) and link not in links:
            yield Problem(f"{key}[{index}].link", f"no link '{link}'; {near(link, links)}")


def _roles(axes: list[Raw], roles: Mapping[str, str]) -> Iterator[Problem]:
    given = [axis.get("role", axis.get("name")) for axis in axes]
    missing = [role for role in roles if role not in given]
    for index, role in enumerate(given):
        # A role of a wrong type is reported at its own key, and may be any of the missing ones.
        if not isinstance(role, str):
            missing.clear()
        elif role not in roles:
            key = "role" if "role" in axes[index] else "name"
            yield Problem(f"axes[{index}].{key}", f"'{role}' is no role of this kind; {near(role, roles)}")
            # A misspelled role is one mistake: it is not reported as missing, too.
            missing = [one for one in missing if one not in nearest(role, roles)]
        elif role in given[:index]:
            key = f"axes[{index}].{'role' if 'role' in axes[index] else 'name'}"
            free = f"; '{missing.pop(0)}' is free" if missing else ""
            yield Problem(key, f"the role '{role}' is taken by axes[{given.index(role)}], too{free}")
    for role in missing:
        yield Problem("axes", f"no axis has the role '{role}', which the group '{roles[role]}' needs")


def _profiles(axes: list[Raw]) -> Iterator[Problem]:
    """Check that no profile is faster than the guard lets through: its drive could not be set up."""
    for index, axis in enumerate(axes):
        profile = _within(_within(axis, "settings"), "profile")
        if axis.get("command") == "position":
            bound = "top_speed"
            rpm = _number(axis.get("top_speed")) * _number(axis.get("ratio")) * RPM_PER_RAD_S
        else:
            bound, rpm = "max_velocity_rpm", _number(profile.get("max_velocity_rpm"))
        velocity = _number(profile.get("velocity_rpm"))
        # Every comparison with NaN is false: a value that is missing here is reported elsewhere.
        if velocity > rpm * (1.0 + ROUNDING):
            key = f"axes[{index}].settings.profile.velocity_rpm"
            yield Problem(key, f"{velocity:.10g} is above {bound}, which is {rpm:.5g} rpm of the motor")


def _at_drives(key: str, rows: list[Raw], axes: list[Raw], links: Collection[str]) -> Iterator[Problem]:
    """Check that each row is at the drive of an axis on its own link, and alone at its pin."""
    found = {str(axis.get("name")): axis.get("link") for axis in axes}
    pins: dict[tuple[object, int], int] = {}
    for index, row in enumerate(rows):
        settings = _within(row, "settings")
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


def _battery(table: Raw, rows: list[Raw]) -> Iterator[Problem]:
    sensor, sensors = _within(table, "battery").get("sensor"), [str(row.get("name")) for row in rows]
    if isinstance(sensor, str) and sensor not in sensors:
        yield Problem("battery.sensor", f"no sensor '{sensor}'; {near(sensor, sensors)}")
    elif any(row.get("name") == sensor and "body" in _within(row, "settings") for row in rows):
        yield Problem("battery.sensor", f"'{sensor}' is a captured body, which has no voltage")


def _supplied(table: Raw, axes: list[Raw]) -> Iterator[Problem]:
    """Check that each drive takes the battery's voltage."""
    nominal = _within(table, "battery").get("nominal_v")
    types = {one.value: one.supply_v for one in Epos2Device}
    for axis in axes:
        device = _within(axis, "settings").get("device")
        most = types.get(device) if isinstance(device, str) else None
        if most is not None and isinstance(nominal, int | float) and nominal > most:
            problem = f"{nominal:g} V: the EPOS2 {device} of '{axis.get('name')}' takes {most} V at most"
            yield Problem("battery.nominal_v", problem)
            return


def _captured(axes: list[Raw], sensors: list[Raw], links: Mapping[str, Raw]) -> Iterator[Problem]:
    """Check that bodies, and nothing else, are on the links to capture systems."""
    systems = {name for name, link in links.items() if link.get("driver") in list(CaptureDriver)}
    for index, axis in enumerate(axes):
        if axis.get("link") in systems:
            yield Problem(f"axes[{index}].link", f"'{axis['link']}' is a capture system, which moves nothing")
    for index, sensor in enumerate(sensors):
        link, is_body = sensor.get("link"), "body" in _within(sensor, "settings")
        if link in links and is_body != (link in systems):
            problem = "needs body" if link in systems else f"has a body, and '{link}' is no capture system"
            yield Problem(f"sensors[{index}].settings", problem)
    joined = [index for index, row in enumerate(sensors) if "odometry" in _within(row, "settings")]
    for index in joined[1:]:
        problem = f"the robot is located by sensors[{joined[0]}] already; leave odometry out here"
        yield Problem(f"sensors[{index}].settings.odometry", problem)


def _guarded(table: Raw, axes: list[Raw]) -> Iterator[Problem]:
    guard = _within(table, "guard")
    names = [str(axis.get("name")) for axis in axes]
    by_position = [str(axis.get("name")) for axis in axes if axis.get("command") == "position"]
    for key in ("sums", "exclusive"):
        yield from _once(_tables(guard, key), f"guard.{key}", "name")
    for index, row in enumerate(_tables(guard, "sums")):
        for axis in _within(row, "of"):
            key = f"guard.sums[{index}].of.{axis}"
            if axis not in names:
                yield Problem(key, f"no such axis; {near(axis, names)}")
            elif axis in by_position:
                yield Problem(key, "is commanded by position; a sum is of axes with command = 'speed'")
    for index, row in enumerate(_tables(guard, "exclusive")):
        yield from _apart(f"guard.exclusive[{index}]", row, names)


def _apart(key: str, row: Raw, names: list[str]) -> Iterator[Problem]:
    """Check two sides that exclude each other: axes that exist, each on one of them."""
    one, other = ([axis for axis in side if isinstance(axis, str)] for side in _sides(row))
    for name, side in (("one", one), ("other", other)):
        for axis in side:
            if axis not in names:
                yield Problem(f"{key}.{name}", f"no axis '{axis}'; {near(axis, names)}")
    for axis in other:
        if axis in one:
            yield Problem(f"{key}.other", f"'{axis}' is on the side 'one', too; it would exclude itself")


def _sides(row: Raw) -> Iterator[list[object]]:
    for name in ("one", "other"):
        side = row.get(name)
        yield side if isinstance(side, list) else []


def _carried(name: str, link: Raw, axes: list[Raw], sensors: list[Raw]) -> Iterator[Problem]:
    """Check one link: at least one device on it, none twice, and a node for a gateway to watch."""
    own = [(index, axis) for index, axis in enumerate(axes) if axis.get("link") == name]
    nodes: dict[int, int] = {}
    for index, axis in own:
        node = _within(axis, "settings").get("node")
        key = f"axes[{index}].settings.node"
        if not isinstance(node, int):
            continue
        if node in nodes:
            yield Problem(key, f"{node} is the node of axes[{nodes[node]}], too")
        # The bridge's heartbeat would be taken for that drive's, and the other way round.
        elif node == link.get("bridge_node"):
            yield Problem(key, f"{node} is the bridge's own node, links.{name}.bridge_node")
        nodes.setdefault(node, index)
    if not own and not any(sensor.get("link") == name for sensor in sensors):
        yield Problem(f"links.{name}", "no axis and no sensor is on this link")
    yield from _watched(name, link, nodes)


def _watched(name: str, link: Raw, nodes: Collection[int]) -> Iterator[Problem]:
    gateway = link.get("gateway")
    if link.get("driver") == SERIAL and gateway in NODE_IDS and nodes:
        # The gateway does not receive its own frames, so it can only watch another drive of the bus.
        if gateway not in nodes:
            yield Problem(f"links.{name}.gateway", f"{gateway} is not the node of an axis on this link")
        elif len(nodes) == 1:
            yield Problem(f"links.{name}.gateway", "a drive without another one behind it watches no one")


def _in_time(name: str, link: Raw, cycle_ms: object) -> Iterator[Problem]:
    every, silent_ms = link.get("every", 1), link.get("silent_ms")
    if not (isinstance(cycle_ms, int) and isinstance(every, int) and isinstance(silent_ms, int)):
        return
    # Between two samples of a healthy device lies a whole cycle of its link.
    if silent_ms <= every * cycle_ms:
        problem = f"{silent_ms} is not longer than the link's cycle, {every * cycle_ms}"
        yield Problem(f"links.{name}.silent_ms", problem)
    for step, time_ms in _within(link, "stop_confirmed_ms").items():
        # One sample may have been requested just before, and the next one may be lost.
        if isinstance(time_ms, int) and step in BY_SAMPLES and time_ms <= 2 * every * cycle_ms:
            problem = f"{time_ms} is not longer than two of the link's cycles, {2 * every * cycle_ms}"
            yield Problem(f"links.{name}.stop_confirmed_ms.{step}", problem)


def _stopping(name: str, link: Raw, axes: list[Raw], roles: Mapping[str, str]) -> Iterator[Problem]:
    """Check the groups that stop with the link: they exist, and no axis on the link is left out."""
    stops = link.get("stops")
    if not isinstance(stops, list):
        return
    groups = sorted(set(roles.values()))
    unknown = [group for group in stops if isinstance(group, str) and group not in groups]
    for group in unknown:
        yield Problem(f"links.{name}.stops", f"no group '{group}' in this kind; {near(group, groups)}")
    for axis in axes if not unknown else ():
        role = axis.get("role", axis.get("name"))
        needed = roles.get(role) if isinstance(role, str) else None
        if axis.get("link") == name and needed is not None and needed not in stops:
            problem = f"leaves out the group '{needed}', whose axis '{axis.get('name')}' is on this link"
            yield Problem(f"links.{name}.stops", problem)


def _once(rows: list[Raw], key: str, field: str) -> Iterator[Problem]:
    seen: dict[str, int] = {}
    for index, row in enumerate(rows):
        value = row.get(field)
        if not isinstance(value, str):
            continue
        if value in seen:
            yield Problem(f"{key}[{index}].{field}", f"'{value}' is taken by {key}[{seen[value]}], too")
        seen.setdefault(value, index)


def _number(value: object) -> float:
    """Return a number; NaN, which is above nothing, for no number or one that is reported elsewhere."""
    try:
        return float(value) if isinstance(value, int | float) else math.nan
    except OverflowError:
        return math.nan


def _tables(table: Raw, key: str) -> list[Raw]:
    rows = table.get(key)
    return [row if isinstance(row, dict) else {} for row in rows] if isinstance(rows, list) else []


def _named(table: Raw, key: str) -> dict[str, Raw]:
    return {name: row for name, row in _within(table, key).items() if isinstance(row, dict)}


def _within(table: Raw, key: str) -> Raw:
    inner = table.get(key)
    return inner if isinstance(inner, dict) else {}
