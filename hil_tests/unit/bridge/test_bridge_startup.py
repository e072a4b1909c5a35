import pytest
from hypothesis import given, settings

from firmware_bridge.bridge import Bridge, Phase
from firmware_bridge.wire.abort import AbortCode
from firmware_bridge.wire.cia402 import State
from firmware_bridge.wire.epos2 import address as at


def test_four_drives_are_found_set_up_and_enabled(bench):
    bench.starts()
    assert {name: drive.state for name, drive in bench.drives.items()} == dict.fromkeys(
        ("left", "right", "steer", "lift"), State.OPERATION_ENABLED
    )
    assert bench.bridge.failure is None
