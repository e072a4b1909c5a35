"""Benchmarks run at night alone: what they import has to be there on every day."""

import importlib
from pathlib import Path

import pytest

FOLDER = Path(__file__).parents[2] / "benchmarks"


@pytest.mark.parametrize("name", sorted(path.stem for path in FOLDER.glob("*.py")))
def test_what_a_benchmark_imports_is_there(name: str) -> None:
    assert importlib.import_module(f"benchmarks.{name}").__doc__
