"""Pytest within pytest forgets what it has imported, and some of that can be imported once only."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

if TYPE_CHECKING:
    from types import ModuleType

HOME = str(Path.home())


class Imported:
    """A plugin of the inner pytest: what it has imported, to be put back."""

    def __init__(self) -> None:
        self._modules: dict[str, ModuleType] = {}

    def pytest_unconfigure(self) -> None:
        self._modules = {name: it for name, it in sys.modules.items() if not name.startswith("test_")}

    def put_back(self) -> None:
        sys.modules.update({name: it for name, it in self._modules.items() if name not in sys.modules})


@pytest.fixture(autouse=True)
def imported() -> Iterator[Imported]:
    """Outlive pytester, whose end is the last to forget."""
    one = Imported()
    yield one
    one.put_back()


@pytest.fixture
def home(monkeypatch: pytest.MonkeyPatch, request: pytest.FixtureRequest) -> None:
    """Let the inner pytest find the plants that are built: pytester has an empty home."""
    request.getfixturevalue("pytester")
    monkeypatch.setenv("HOME", HOME)
