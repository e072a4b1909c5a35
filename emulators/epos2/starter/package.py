"""Writer of a package from its templates; it never replaces an existing file."""

from importlib.resources import files
from importlib.resources.abc import Traversable
from pathlib import Path
from string import Template
from typing import Final

from emulators.epos2.starter.numbers import Specification, worked_out
from emulators.specification import SpecificationError

TEMPLATES: Final = "templates"
SUFFIX: Final = ".template"
NAME: Final = "NAME"
"""Stands for the robot's name in the templates' paths."""


def written(given: Specification) -> dict[str, str]:
    """Return the files of a package, by their paths in it; SpecificationError."""
    words = worked_out(given)
    texts = {}
    for path, template in _templates(files("emulators.epos2.starter") / TEMPLATES / given.kind, ""):
        name = path.removesuffix(SUFFIX).replace(NAME, given.name)
        texts[name] = Template(template.read_text(encoding="utf-8")).substitute(words)
    return texts


def write(given: Specification, folder: Path) -> tuple[Path, ...]:
    """Write a package into a folder that is not there yet; SpecificationError, OSError."""
    texts = written(given)
    if folder.exists():
        raise SpecificationError(f"{folder} is there already; take another --dir, or remove it")
    paths = []
    for name, text in texts.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
        paths.append(path)
    return tuple(paths)


def kinds() -> list[str]:
    """Return the kinds for which there are templates."""
    return sorted(
        one.name for one in (files("emulators.epos2.starter") / TEMPLATES).iterdir() if one.is_dir()
    )


def _templates(folder: Traversable, path: str) -> list[tuple[str, Traversable]]:
    found: list[tuple[str, Traversable]] = []
    for one in sorted(folder.iterdir(), key=lambda one: one.name):
        name = f"{path}{one.name}"
        found += _templates(one, f"{name}/") if one.is_dir() else [(name, one)]
    return found
