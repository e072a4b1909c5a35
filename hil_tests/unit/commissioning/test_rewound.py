"""A client's jobs taken back to the middle of them go on as they went, to the byte."""

import pytest

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.commissioning.client import JobClient
from firmware_bridge.families.epos2.commissioning.overview import Overview
from firmware_bridge.families.epos2.commissioning.power import PowerCommand, Wanted
from firmware_bridge.families.epos2.commissioning.reading import Reading
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.commissioning.rig import WAYS, Way, rig_for


@pytest.mark.long(keeps=["1-can", "8-v1", "20-v2", "3-v1 by number"])
@pytest.mark.parametrize("way", WAYS, ids=str)
@pytest.mark.parametrize("after", [0, 1, 3, 8, 20, 60])
def test_jobs_that_were_taken_back_go_on_as_they_went(way: Way, after: int) -> None:
    rig = rig_for(way)
    reading, overview = Reading([od.DEVICE_NAME, Address(0x2004), od.STATUSWORD]), Overview(alone=False)
    script = (*reading.once(), *PowerCommand(Wanted.ENABLE).script(), *overview.script())
    client = JobClient(way.link(), script)
    rig.world.attach("client", client, {CAN: rig.bus} if way.generation is None else {SERIAL: rig.line})
    rig.waits(after * MILLISECOND)
    kept = rig.world.snapshot()
    ends = []
    for _ in range(2):
        rig.waits(500 * MILLISECOND)
        assert client.finished
        assert client.failure is None
        ends.append((rig.world.trace_sha256, dict(reading.found), overview.state, overview.mode))
        rig.world.restore(kept)
    assert ends[0] == ends[1]
    assert ends[0][1][od.DEVICE_NAME] == b"EPOS2"
