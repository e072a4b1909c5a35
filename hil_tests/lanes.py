"""Number of examples that a test draws, and the share of the tests that runs.

All that a test requests, or a tenth of them in the first lane. Hypothesis times none: the tests' time is
virtual, and wall time depends on the machine's load. As a plugin of pytest, `-p hil_tests.lanes --share K/N`,
it leaves out what is not in the share.
"""

import argparse
import hashlib
from dataclasses import dataclass
from typing import Final

import pytest
from hypothesis import settings

FULL: Final = 100
FIRST_LANE: Final = "first-lane"
HUNG_S: Final = 300.0
"""Time after which a process that should have ended hangs; a busy machine takes less."""

settings.register_profile("virtual time", settings(deadline=None, max_examples=FULL))
settings.register_profile(FIRST_LANE, settings(deadline=None, max_examples=FULL // 10))
settings.load_profile("virtual time")


def examples(count: int) -> int:
    """Return how many of a test's examples this run draws; the profile is loaded before tests are read."""
    return -(-count * settings().max_examples // FULL)


@dataclass(frozen=True, slots=True)
class Share:
    """One of `of` shares of the tests, counted from 1; each test is in one of them, by its name."""

    number: int
    of: int

    @classmethod
    def parse(cls, text: str) -> "Share":
        """Read `K/N`; the exception names the error."""
        number, _, of = text.partition("/")
        if number.isdigit() and of.isdigit() and 1 <= int(number) <= int(of):
            return cls(int(number), int(of))
        raise argparse.ArgumentTypeError(f"{text!r} is no share: write K/N, with K from 1 to N")

    def has(self, name: str) -> bool:
        """Return whether the test of this name is in it."""
        return int(hashlib.sha256(name.encode()).hexdigest(), 16) % self.of == self.number - 1


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the option."""
    parser.addoption("--share", type=Share.parse, metavar="K/N", help="run the K-th of N shares of the tests")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is in another share."""
    share: Share | None = config.getoption("share", None)
    if share is not None:
        config.hook.pytest_deselected(items=[item for item in items if not share.has(item.nodeid)])
        items[:] = [item for item in items if share.has(item.nodeid)]
