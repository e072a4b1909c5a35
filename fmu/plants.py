"""Registry of plants: packages bring them, ours as others, under the group `firmware_bridge.plants`.

It is independent of robots: a plant's values from a robot's file are looked up by paths that it gives.
"""

import difflib
import importlib
import sys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Final

from fmu.errors import PlantError, UnknownNameError
from fmu.export.about import About
from fmu.export.model import Parameter

if TYPE_CHECKING:
    from fmu.export.model import Model

GROUP: Final = "firmware_bridge.plants"
UNKNOWN: Final = About()


ONLY: Final = "*"
"""In a path: the only row of a table, whatever its name."""


@dataclass(frozen=True, slots=True)
class Plant:
    """A plant that can be built; an entry point names such a value.

    In `package`, an import path, stands `equations.py` with a function `model()`, and all that it needs
    beside `fmu.parts` and `made_of`. Making a Plant must be quick: SymPy comes with the equations, when they
    are requested.
    """

    name: str
    package: str
    parameters: tuple[Parameter, ...]
    sets: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    """Named start values of some parameters, in SI units."""
    robot_file: Mapping[str, tuple[str, float]] = field(default_factory=dict)
    """Path into a robot's file, rows of a table by their name -> parameter, and the factor into its unit.

    Paths to one parameter must give one value.
    """
    made_of: tuple[str, ...] = ()
    """The packages of other plants whose equations it takes."""
    starts: Mapping[str, float] = field(default_factory=dict)
    """Start values in place of the parameters' own, in SI units: see `starting`."""
    stops: Mapping[str, tuple[str, str]] = field(default_factory=dict)
    """Axis -> the parameters of its lower and its upper stop, in the unit of the axis in a robot's file."""
    grips: bool = False
    """True if it can lose its grip on a wall: it has an input `grip_lost_AXIS` for each axis."""

    def model(self) -> "Model":
        """Return equations and tables; `outputs` are what can be read, each with unit and meaning."""
        model: Model = importlib.import_module(f"{self.package}.equations").model()
        if model.name != self.name:
            raise PlantError(f"{self.package}: the plant '{self.name}' has equations called '{model.name}'")
        return replace(model, parameters=_started(model.parameters, self.starts)) if self.starts else model

    def starting(self, values: Mapping[str, float]) -> "Plant":
        """Return the plant of one robot: its parameters begin with these; UnknownNameError."""
        known = {row.name for row in self.parameters}
        for name in values:
            if name not in known:
                raise _unknown(f"the plant '{self.name}' has no parameter", name, known)
        own = {row.name: row.start for row in self.parameters}
        others = {name: value for name, value in values.items() if value != own[name]}
        # One that begins as it does anyway is the one that comes with the package, and needs no compiler.
        return replace(self, starts=others, parameters=_started(self.parameters, others)) if others else self

    def parameter_set(self, name: str) -> dict[str, float]:
        """Return a named parameter set; UnknownNameError where there is none."""
        if name not in self.sets:
            raise _unknown(f"the plant '{self.name}' has no parameter set", name, self.sets)
        return dict(self.sets[name])

    def parameters_of(self, robot: object) -> dict[str, float]:
        """Return the parameters that a robot's file gives, in the plant's units.

        UnknownNameError, naming the path, where the robot has no such value; PlantError where it has two
        values for what the plant has once.
        """
        found: dict[str, float] = {}
        given: dict[str, str] = {}
        for path, (name, factor) in self.robot_file.items():
            value = factor * _at(robot, path, self.name)
            # Exactly: both are in the robot's file, and the plant can have one of them only.
            if found.setdefault(name, value) != value:
                one, other = found[name] / factor, value / factor
                raise PlantError(
                    f"the plant '{self.name}' has one '{name}' for {given[name]} = {one:g} and {path} = "
                    f"{other:g}: make them equal, or give the robot a plant of its own"
                )
            given.setdefault(name, path)
        return found


def _started(rows: Iterable[Parameter], starts: Mapping[str, float]) -> tuple[Parameter, ...]:
    """Return rows with the start values of one robot, which its file gives."""
    return tuple(
        replace(row, start=starts[row.name], source="the robot file")
        if starts.get(row.name, row.start) != row.start
        else row
        for row in rows
    )


def names() -> list[str]:
    """Return the names of the installed plants, without loading any."""
    return sorted({entry.name for entry in _entries()})


def find(name: str) -> Plant:
    """Return an installed plant; UnknownNameError where there is none, PlantError where it is none."""
    entries = _entries().select(name=name)
    if not entries:
        raise _unknown("there is no plant", name, names())
    values = sorted({entry.value for entry in entries})
    if len(values) > 1:
        raise PlantError(f"two plants are called '{name}': {' and '.join(values)}; uninstall one of them")
    try:
        plant = next(iter(entries)).load()
    except Exception as error:
        raise PlantError(f"the plant '{name}' cannot be loaded from {values[0]}: {error}") from error
    if not isinstance(plant, Plant) or plant.name != name:
        raise PlantError(f"{values[0]} is not the plant '{name}', but {plant!r:.60}: correct the entry point")
    return plant


def origin(plant: Plant) -> About:
    """Return the origin of a plant by the metadata of its installed package; empty where there is none."""
    return _origin(plant.name, plant.package, tuple(sys.path))


@cache
def _origin(name: str, package: str, path: tuple[str, ...]) -> About:
    for entry in _entries_on(path).select(name=name):
        if entry.dist is not None and entry.value.partition(":")[0].startswith(package):
            about = entry.dist.metadata
            text = _licence(entry.dist)
            author, mail, licence = (
                (about.get_all(field) or [""])[0]
                for field in ("Author", "Author-email", "License-Expression")
            )
            author = author or mail
            known = About(entry.dist.version, author, licence, text)
            holder = known.copyright.rpartition(")")[2].strip().lstrip("0123456789 -,")
            return known if author else replace(known, author=holder)
    return UNKNOWN


def _entries() -> metadata.EntryPoints:
    return _entries_on(tuple(sys.path))


@cache
def _entries_on(_path: tuple[str, ...]) -> metadata.EntryPoints:
    """Read the entry points on this path once: it takes milliseconds, and each robot needs them."""
    return metadata.entry_points(group=GROUP)


def _licence(distribution: metadata.Distribution) -> str:
    """Return the text of a package's license (Python packaging, PEP 639), empty where it brings none."""
    for name in distribution.metadata.get_all("License-File") or ():
        if text := distribution.read_text(f"licenses/{name}"):
            return text
        # A checkout has it beside its metadata, not in them.
        beside = Path(str(distribution.locate_file(name)))
        if beside.is_file():
            return beside.read_text(encoding="utf-8")
    return ""


def _unknown(problem: str, name: str, known: Iterable[str]) -> UnknownNameError:
    known = tuple(known)
    near = difflib.get_close_matches(name, known, n=1)
    hint = f"did you mean '{near[0]}'? " if near else ""
    return UnknownNameError(f"{problem} '{name}'; {hint}there are: {', '.join(known) or 'none'}")


def _at(robot: object, path: str, plant: str) -> float:
    """Return the number at the end of a path: by key, by the `name` of a row, `ONLY` row, or by attribute."""
    found = robot
    for part in path.split("."):
        rows = _rows(found)
        if part in rows:
            found = rows[part]
        elif part == ONLY and len(rows) == 1:
            (found,) = rows.values()
        elif part.isidentifier() and hasattr(found, part):
            found = getattr(found, part)
        else:
            raise _unknown(
                f"the plant '{plant}' takes '{path}' from the robot's file, which has no", part, rows
            )
    if isinstance(found, bool) or not isinstance(found, (int, float)):
        raise UnknownNameError(f"the plant '{plant}' takes '{path}' from the robot's file: that is no number")
    return float(found)


def _rows(owner: object) -> Mapping[str, object]:
    if isinstance(owner, Mapping):
        return owner
    if isinstance(owner, Sequence):
        return {str(getattr(row, "name", place)): row for place, row in enumerate(owner)}
    slots: Mapping[str, object] = dict.fromkeys(getattr(owner, "__slots__", ()))
    return getattr(owner, "__dict__", slots)
