"""Extras of the package: a check that one is installed, and the line that installs it."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib.util import find_spec
from types import MappingProxyType
from typing import Final, Literal, TypeAlias

Extra: TypeAlias = Literal["campaign", "cluster", "live", "mcap", "plots", "plants", "search"]

LIBRARIES: Final[Mapping[Extra, tuple[str, ...]]] = MappingProxyType(
    {
        "campaign": ("scipy", "pyarrow"),
        "cluster": ("distributed",),
        "live": ("websockets",),
        # Foxglove's schemas bring protobuf; another package may have brought `mcap` alone.
        "mcap": ("mcap", "foxglove_schemas_protobuf"),
        "plots": ("matplotlib",),
        "plants": ("sympy",),
        "search": ("optuna",),
    }
)
"""The libraries by which each extra is known."""
MISSING: Final[Mapping[Extra, str]] = MappingProxyType(
    {
        "campaign": "Latin hypercubes, Sobol and Parquet need SciPy and PyArrow, which are not installed",
        "cluster": "a scheduler is Dask's, which is not installed",
        "live": "the live page is served by the library websockets, which is not installed",
        "mcap": "recordings in MCAP need the library mcap and Foxglove's schemas, which are not installed",
        "plots": "pictures are drawn by Matplotlib, which is not installed",
        "plants": "a plant's equations are SymPy's, which is not installed",
        "search": "a search for worst cases is Optuna's, which is not installed",
    }
)


class ExtraMissingError(LookupError):
    """A requested feature needs an extra that is missing; the message names it, and the way to install it."""


def installed(extra: Extra) -> bool:
    """Return whether an extra is here, without importing it."""
    return all(find_spec(library) is not None for library in LIBRARIES[extra])


def remedy_of(extra: Extra) -> str:
    """Return what is missing without an extra, and the line that installs it."""
    return f"{MISSING[extra]}: pip install 'firmware-bridge[{extra}]'"


@contextmanager
def from_extras() -> Iterator[None]:
    """Import in here what may need an extra; ExtraMissingError where that is not installed."""
    try:
        yield
    except ModuleNotFoundError as error:
        library = (error.name or "").partition(".")[0]
        for extra, needed in LIBRARIES.items():
            if library in needed:
                raise ExtraMissingError(remedy_of(extra)) from None
        raise
