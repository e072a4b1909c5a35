"""Which tests this machine can run: some need a SocketCAN bus vcan0, a network without a way out, or tshark.

What is not there leaves its tests out, and counted: `tools/with-vcan` brings a kernel with the bus,
`tools/with-loopback` the network, Debian's package tshark the dissector. Those of other machines' binaries
need cross compilers, Wine and qemu-user, that of the sketch simavr; they run only where their mark is asked
for, and then fail where something is missing. `.ci/run` has all. Which tests are long says `lanes.toml`,
beside the marks of a few.
"""

import gc
import shutil
import socket
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final, TypedDict, cast

import pytest

import hil_tests.lanes  # noqa: F401 - what Hypothesis draws
from hil_tests import rows as tables

AT_HAND: Final = {
    "vcan": Path("/sys/class/net/vcan0").exists(),
    "alone": [name for _, name in socket.if_nameindex()] == ["lo"],
    "tshark": shutil.which("tshark") is not None,
}
"""Markers, and whether this machine has what they stand for."""

ON_DEMAND: Final = ("platforms", "avr", "installed")
"""Markers whose tests run where they are asked for by name, `-m MARKER`."""


class Longer(TypedDict, total=False):
    """A row of `lanes.toml`."""

    keeps: list[str]
    beside: str


def rows(table: dict[str, Any], above: str = "") -> Iterator[tuple[str, Longer]]:
    """Yield what is long by its file and name, as pytest writes them."""
    for name, found in table.items():
        if name.startswith("test_") and not any(isinstance(it, dict) for it in found.values()):
            yield f"{above}.py::{name}", cast("Longer", found)
        else:
            yield from rows(found, f"{above}/{name}" if above else name)


LONG: Final = dict(rows(tomllib.loads(Path(__file__).with_name("lanes.toml").read_text(encoding="utf-8"))))


def pytest_configure(config: pytest.Config) -> None:
    tables.configure(config)


def pytest_itemcollected(item: pytest.Item) -> None:
    name, _, case = item.nodeid.removeprefix("hil_tests/").partition("[")
    row = LONG.get(name)
    if row is not None and case.removesuffix("]") not in row.get("keeps", ()):
        item.add_marker(pytest.mark.long(beside=row.get("beside", "")))


gc.set_threshold(500_000, 20, 100)
"""At Python's own pace the collector of garbage takes a quarter of the tests' time, and finds little."""


def pytest_collection_finish() -> None:
    """Spare the collector thirteen thousand tests, which live to the end."""
    gc.collect()
    gc.freeze()


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    missing = [marker for marker, there in AT_HAND.items() if not there]
    missing += [marker for marker in ON_DEMAND if marker not in config.getoption("markexpr")]
    without = [item for item in items if any(item.get_closest_marker(marker) for marker in missing)]
    if without:
        config.hook.pytest_deselected(items=without)
        items[:] = [item for item in items if item not in without]
