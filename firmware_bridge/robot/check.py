"""What the tables of a robot file must say of each other: names that exist, once each; links that carry.

It looks at the raw tables, so that these mistakes are told together with those of single keys.
"""

from collections.abc import Iterator, Mapping
from typing import Final, TypeAlias

from firmware_bridge.robot.problems import Problem, near

Raw: TypeAlias = Mapping[str, object]
SERIAL: Final = "epos2-serial"


def cross_checked(table: Raw, roles: Mapping[str, str]) -> Iterator[Problem]:
    """Yield what does not fit together; `roles` are those that the robot's kind knows, with their group."""
    axes, sensors, outputs = (_tables(table, key) for key in ("axes", "sensors", "outputs"))
    links = _named(table, "links")
    for key, rows in (("axes", axes), ("sensors", sensors), ("outputs", outputs)):
        yield from _once(rows, key, "name")
        for index, row in enumerate(rows):
            link = row.get("link")
            if isinstance(link, str) and link not in links:
                yield Problem(f"{key}[{index}].link", f"no link '{link}'; {near(link, links)}")
    yield from _roles(axes, roles)
    names = [str(axis.get("name")) for axis in axes]
    for key, rows in (("sensors", sensors), ("outputs", outputs)):
        yield from _at_drives(key, rows, axes)
    yield from _battery(table, [str(sensor.get("name")) for sensor in sensors])
    by_speed = [str(axis.get("name")) for axis in axes if axis.get("command") == "speed"]
    yield from _guarded(table, names, by_speed)
    for name, link in links.items():
        yield from _carried(name, link, axes, sensors)
        yield from _in_time(name, link, table.get("cycle_ms"))


def _roles(axes: list[Raw], roles: Mapping[str, str]) -> Iterator[Problem]:
    told = [str(axis.get("role", axis.get("name"))) for axis in axes]
    for index, role in enumerate(told):
        if role not in roles:
            key = "role" if "role" in axes[index] else "name"
            yield Problem(f"axes[{index}].{key}", f"'{role}' is no role of this kind; {near(role, roles)}")
        elif role in told[:index]:
            yield Problem(f"axes[{index}].role", f"'{role}' is taken by axes[{told.index(role)}], too")
    for role, group in roles.items():
        if role not in told:
            yield Problem("axes", f"no axis has the role '{role}', which the group '{group}' needs")


def _at_drives(key: str, rows: list[Raw], axes: list[Raw]) -> Iterator[Problem]:
    """Check that each row is at the drive of an axis on its own link, and alone at its pin."""
    links = {str(axis.get("name")): axis.get("link") for axis in axes}
    pins: dict[tuple[object, object], int] = {}
    for index, row in enumerate(rows):
        settings = _within(row, "settings")
        axis, pin = settings.get("axis"), (settings.get("axis"), settings.get("output"))
        if not isinstance(axis, str):
            continue
        if axis not in links:
            yield Problem(f"{key}[{index}].settings.axis", f"no axis '{axis}'; {near(axis, links)}")
        elif links[axis] != row.get("link"):
            yield Problem(f"{key}[{index}].link", f"the axis '{axis}' is on the link '{links[axis]}'")
        if None not in pin and pin in pins:
            yield Problem(f"{key}[{index}].settings.output", f"{pin[1]} is that of {key}[{pins[pin]}], too")
        pins.setdefault(pin, index)


def _battery(table: Raw, sensors: list[str]) -> Iterator[Problem]:
    sensor = _within(table, "battery").get("sensor")
    if isinstance(sensor, str) and sensor not in sensors:
        yield Problem("battery.sensor", f"no sensor '{sensor}'; {near(sensor, sensors)}")


def _guarded(table: Raw, names: list[str], by_speed: list[str]) -> Iterator[Problem]:
    guard = _within(table, "guard")
    for index, row in enumerate(_tables(guard, "sums")):
        for axis in _within(row, "of"):
            key = f"guard.sums[{index}].of.{axis}"
            if axis not in names:
                yield Problem(key, f"no such axis; {near(axis, names)}")
            elif axis not in by_speed:
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
    """Check one link: somebody is on it, nobody twice, and a gateway has somebody to watch."""
    own = [(index, axis) for index, axis in enumerate(axes) if axis.get("link") == name]
    nodes: dict[object, int] = {}
    for index, axis in own:
        node = _within(axis, "settings").get("node")
        if node is not None:
            yield from _node(f"axes[{index}].settings.node", node, nodes, (name, link.get("bridge_node")))
            nodes.setdefault(node, index)
    if not own and not any(sensor.get("link") == name for sensor in sensors):
        yield Problem(f"links.{name}", "no axis and no sensor is on this link")
    gateway = link.get("gateway")
    if link.get("driver") == SERIAL and gateway is not None and nodes:
        if gateway not in nodes:
            yield Problem(f"links.{name}.gateway", f"{gateway} is not the node of an axis on this link")
        elif len(nodes) == 1:
            yield Problem(f"links.{name}.gateway", "a drive without another one behind it watches nobody")


def _node(
    key: str, node: object, taken: Mapping[object, int], bridge: tuple[str, object]
) -> Iterator[Problem]:
    link, own = bridge
    if node in taken:
        yield Problem(key, f"{node} is the node of axes[{taken[node]}], too")
    elif node == own:
        yield Problem(key, f"{node} is the bridge's own node, links.{link}.bridge_node")


def _in_time(name: str, link: Raw, cycle_ms: object) -> Iterator[Problem]:
    every, silent_ms = link.get("every", 1), link.get("silent_ms")
    if not (isinstance(cycle_ms, int) and isinstance(every, int) and isinstance(silent_ms, int)):
        return
    cycle = every * cycle_ms
    if silent_ms <= cycle:
        yield Problem(f"links.{name}.silent_ms", f"{silent_ms} is not longer than the link's cycle, {cycle}")


def _once(rows: list[Raw], key: str, field: str) -> Iterator[Problem]:
    seen: dict[object, int] = {}
    for index, row in enumerate(rows):
        value = row.get(field)
        if value in seen:
            yield Problem(f"{key}[{index}].{field}", f"'{value}' is taken by {key}[{seen[value]}], too")
        elif isinstance(value, str):
            seen[value] = index


def _tables(table: Raw, key: str) -> list[Raw]:
    rows = table.get(key)
    return [row if isinstance(row, dict) else {} for row in rows] if isinstance(rows, list) else []


def _named(table: Raw, key: str) -> dict[str, Raw]:
    return {name: row for name, row in _within(table, key).items() if isinstance(row, dict)}


def _within(table: Raw, key: str) -> Raw:
    inner = table.get(key)
    return inner if isinstance(inner, dict) else {}
