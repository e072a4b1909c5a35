"""Which tests this machine can run: those marked `vcan` need a kernel with a SocketCAN bus vcan0.

Where there is none they are left out, and counted; `tools/with-vcan` brings such a kernel.
"""

from pathlib import Path
from typing import Final

import pytest

VCAN: Final = Path("/sys/class/net/vcan0")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    if VCAN.exists():
        return
    without = [item for item in items if item.get_closest_marker("vcan") is not None]
    if without:
        config.hook.pytest_deselected(items=without)
        items[:] = [item for item in items if item.get_closest_marker("vcan") is None]
