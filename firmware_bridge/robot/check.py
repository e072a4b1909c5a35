"""Consistency of a robot file's tables: names that exist, once each; links that carry.

The check reads the raw tables, so that these mistakes are reported together with those of single keys.
"""

from collections.abc import Collection, Iterable, Iterator, Mapping
from typing import get_args

from firmware_bridge.family import families, unloadable
from firmware_bridge.robot import raw
from firmware_bridge.robot.family_tables import Kind, table_of, words
from firmware_bridge.robot.problems import Problem, near, nearest
from firmware_bridge.robot.raw import Raw
from firmware_bridge.robot.table import Names, Table


def cross_checked(table: Raw, roles: Mapping[str, str]) -> Iterator[Problem]:
    """Yield the inconsistencies; `roles` are those of the robot type, with their group.

    One mistake is one problem: a reference to an axis or a link is judged only where their own names are
    valid.
    """
    axes, sensors, outputs = (raw.rows(table, key) for key in ("axes", "sensors", "outputs"))
    links = raw.named(table, "links")
    for key, rows in (("axes", axes), ("sensors", sensors), ("outputs", outputs)):
        yield from _once(rows, key, "name")
        if links and len(links) == len(raw.within(table, "links")):
            yield from _linked(key, rows, links)
    if isinstance(table.get("axes"), list):
        yield from _roles(axes, roles)
    for name, link in links.items():
        yield from _known(name, link)
        yield from _used(name, (*axes, *sensors))
        yield from _in_time(name, link, table.get("cycle_ms"))
        yield from _stopping(name, link, axes, roles)
    yield from _battery(table, sensors)
    yield from _of_their_link("axis", "axes", axes, links)
    yield from _of_their_link("sensor", "sensors", sensors, links)
    yield from _of_their_link("output", "outputs", outputs, links)
    yield from (problem for family in families() for problem in family.check(table))
    names = [axis.get("name") for axis in axes]
    # Other tables refer to axes by name: a missing or doubled one is reported already, and would be so again.
    if all(isinstance(name, str) and names.count(name) == 1 for name in names):
        yield from _guarded(table, axes)
        yield from _homed(axes)


def _known(name: str, link: Raw) -> Iterator[Problem]:
    """Give why installed families cannot be loaded, where a link's driver is not known: it may be of one."""
    if str(link.get("driver")) not in words("link"):
        for family, why in unloadable().items():
            yield Problem(f"links.{name}.driver", f"the family '{family}' {why}")


def _used(name: str, rows: Iterable[Raw]) -> Iterator[Problem]:
    if not any(row.get("link") == name for row in rows):
        yield Problem(f"links.{name}", "no axis and no sensor is on this link")


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
    first = raw.within(raw.within(axis, "zero"), "homing").get("after")
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


def sensors_named(geometry: type[Table], table: Raw) -> Iterator[Problem]:
    """Yield the keys of the geometry that name a sensor which is not there."""
    sensors = [str(row.get("name")) for row in raw.rows(table, "sensors")]
    for key, name in _names(geometry, raw.within(table, "geometry"), "geometry"):
        if name not in sensors:
            yield Problem(key, f"no sensor '{name}'; {near(name, sensors)}")


def _names(model: type[Table], table: Raw, place: str) -> Iterator[tuple[str, str]]:
    """Yield each key of a table, and of those within, that names a sensor, with the name."""
    for key, field in model.model_fields.items():
        value, here = table.get(key), f"{place}.{key}"
        if Names.SENSOR in field.metadata and isinstance(value, str):
            yield here, value
        for inner in (field.annotation, *get_args(field.annotation)):
            if isinstance(inner, type) and issubclass(inner, Table) and isinstance(value, dict):
                yield from _names(inner, value, here)


def _battery(table: Raw, rows: list[Raw]) -> Iterator[Problem]:
    sensor, sensors = raw.within(table, "battery").get("sensor"), [str(row.get("name")) for row in rows]
    if isinstance(sensor, str) and sensor not in sensors:
        yield Problem("battery.sensor", f"no sensor '{sensor}'; {near(sensor, sensors)}")
        return
    for row in rows:
        measures = table_of("sensor", raw.within(row, "settings"))
        if row.get("name") == sensor and not getattr(measures, "VOLTAGE", False):
            yield Problem("battery.sensor", f"'{sensor}' measures no voltage")


def _of_their_link(kind: Kind, key: str, rows: list[Raw], links: Mapping[str, Raw]) -> Iterator[Problem]:
    """Check that what is on a link is of the link's family of devices."""
    by_word = words("link")
    for index, row in enumerate(rows):
        name = row.get("link")
        there = links.get(name) if isinstance(name, str) else None
        link = None if there is None else by_word.get(str(there.get("driver")))
        if link is None or not isinstance(row.get("settings"), dict):
            continue
        family = next(one for one in families() if one.link is link)
        own = {"axis": family.axis, "sensor": family.sensor, "output": family.output}[kind]
        if own is None:
            yield Problem(f"{key}[{index}].link", f"'{name}' is {family.title}, which has no {kind}")
        elif table_of(kind, row["settings"]) is not own:
            yield Problem(
                f"{key}[{index}].settings",
                f"are of another device: '{name}' is {family.title}; its keys: {', '.join(own.model_fields)}",
            )


def _guarded(table: Raw, axes: list[Raw]) -> Iterator[Problem]:
    guard = raw.within(table, "guard")
    names = [str(axis.get("name")) for axis in axes]
    by_position = [str(axis.get("name")) for axis in axes if axis.get("command") == "position"]
    for key in ("sums", "exclusive"):
        yield from _once(raw.rows(guard, key), f"guard.{key}", "name")
    for index, row in enumerate(raw.rows(guard, "sums")):
        for axis in raw.within(row, "of"):
            key = f"guard.sums[{index}].of.{axis}"
            if axis not in names:
                yield Problem(key, f"no such axis; {near(axis, names)}")
            elif axis in by_position:
                yield Problem(key, "is commanded by position; a sum is of axes with command = 'speed'")
    for index, row in enumerate(raw.rows(guard, "exclusive")):
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


def _in_time(name: str, link: Raw, cycle_ms: object) -> Iterator[Problem]:
    every, silent_ms = link.get("every", 1), link.get("silent_ms")
    if not (isinstance(cycle_ms, int) and isinstance(every, int) and isinstance(silent_ms, int)):
        return
    # Between two samples of a healthy device lies a whole cycle of its link.
    if silent_ms <= every * cycle_ms:
        problem = f"{silent_ms} is not longer than the link's cycle, {every * cycle_ms}"
        yield Problem(f"links.{name}.silent_ms", problem)


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
