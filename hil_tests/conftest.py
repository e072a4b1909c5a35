"""Which tests this machine can run: some need a SocketCAN bus vcan0, some need tshark beside Python.

What is not there leaves its tests out, and counted: `tools/with-vcan` brings a kernel with the bus, Debian's
package tshark the dissector. `.ci/run` has both.
"""

import shutil
from pathlib import Path
from typing import Final

import pytest

AT_HAND: Final = {
    "vcan": Path("/sys/class/net/vcan0").exists(),
    "tshark": shutil.which("tshark") is not None,
}
"""Markers, and whether this machine has what they stand for."""


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    missing = [marker for marker, there in AT_HAND.items() if not there]
    without = [item for item in items if any(item.get_closest_marker(marker) for marker in missing)]
    if without:
        config.hook.pytest_deselected(items=without)
        items[:] = [item for item in items if item not in without]
