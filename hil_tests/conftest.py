"""Which tests this machine can run: some need a SocketCAN bus vcan0, some need tshark beside Python.

What is not there leaves its tests out, and counted: `tools/with-vcan` brings a kernel with the bus, Debian's
package tshark the dissector. `.ci/run` has both. Hypothesis times no example: the tests' time is virtual, and
the wall's says how busy the machine is.
"""

import shutil
from pathlib import Path
from typing import Final

import pytest
from hypothesis import settings

AT_HAND: Final = {
    "vcan": Path("/sys/class/net/vcan0").exists(),
    "tshark": shutil.which("tshark") is not None,
}
"""Markers, and whether this machine has what they stand for."""

settings.register_profile("virtual time", settings(deadline=None))
settings.load_profile("virtual time")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    missing = [marker for marker, there in AT_HAND.items() if not there]
    without = [item for item in items if any(item.get_closest_marker(marker) for marker in missing)]
    if without:
        config.hook.pytest_deselected(items=without)
        items[:] = [item for item in items if item not in without]
