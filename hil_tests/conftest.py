"""Selection of tests for this machine: some need a SocketCAN bus vcan0, an isolated network, or tshark.

Tests of missing tools are skipped, and counted: `tools/with-vcan` brings a kernel with the bus,
`tools/with-loopback` the network, Debian's package tshark the dissector. Those of other machines' binaries
need cross compilers, Wine and qemu-user, that of the sketch simavr; they run only where their mark is
requested, and then fail where something is missing: `.ci/run` or `make nightly` has it.
"""

import gc
import shutil
import socket
from pathlib import Path
from typing import Final

import pytest

import hil_tests.lanes  # noqa: F401 - what Hypothesis draws
from hil_tests import invariants
from hil_tests import rows as tables

pytest.register_assert_rewrite("emulators.testing.inherited.test_robot")

AT_HAND: Final = {
    "vcan": Path("/sys/class/net/vcan0").exists(),
    "alone": [name for _, name in socket.if_nameindex()] == ["lo"],
    "tshark": shutil.which("tshark") is not None,
}
"""Markers, and whether this machine has what they stand for."""

ON_DEMAND: Final = ("platforms", "avr", "installed", "released", "browser")
"""Markers whose tests run where they are requested by name, `-m MARKER`."""


def pytest_configure(config: pytest.Config) -> None:
    tables.configure(config)
    invariants.install()


def pytest_itemcollected(item: pytest.Item) -> None:
    """Take the mark `long` from the cases that it keeps in the first lane."""
    case = item.nodeid.partition("[")[2].removesuffix("]")
    item.own_markers = [
        mark for mark in item.own_markers if mark.name != "long" or case not in mark.kwargs.get("keeps", ())
    ]


gc.set_threshold(500_000, 20, 100)
"""The garbage collector at Python's own pace takes a quarter of the tests' time, and finds little."""


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
