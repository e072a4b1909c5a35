"""ROME's runs are taken back to any instant, under cameras and over each firmware, and go on as they went."""

import pytest

from firmware_bridge.units import from_seconds
from hil_tests.scenarios.test_rome_cameras_stories import circling


@pytest.mark.long(keeps=["ros-arduino-bridge-rome+cameras"])
@pytest.mark.parametrize("name", ["rome", "rome+cameras"])
@pytest.mark.parametrize("protocol", ["ros-arduino-bridge", "mw", "arduinoio", "firmata"])
def test_from_each_instant_the_run_goes_on_as_it_went(name: str, protocol: str) -> None:
    """In the set-up, while arming, under way."""
    with circling(name, protocol=protocol) as rig:
        moments = []
        for second in (0.3, 0.9, 1.4, 2.52, 3.3):
            rig.run(from_seconds(second))
            moments.append(rig.snapshot())
        rig.run(from_seconds(3.6))
        trace = rig.world.trace_sha256
        for moment in moments:
            rig.restore(moment)
            rig.run(from_seconds(3.6))
            assert rig.world.trace_sha256 == trace
