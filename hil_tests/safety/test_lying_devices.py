"""A drive, a second node with its number, or a gateway with false reports: a stop order stops the robot."""

import pytest

from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN
from firmware_bridge.units import to_seconds
from hil_tests.rows import every
from hil_tests.safety.driving import ORDERS, changed, driving, runs, speed
from hil_tests.safety.lies import OF_A_DRIVE, OF_A_GATEWAY, on_the_line


@pytest.mark.long(beside="test_whatever_a_drive_and_its_bus_do_it_stops_in_time")
@every("robot", ["rars", "climber"])
@every("lie", OF_A_DRIVE)
@every("order", ORDERS)
def test_a_drive_that_lies_is_stopped(robot: str, lie: str, order: str) -> None:
    fault, change = OF_A_DRIVE[lie]
    with driving(robot) as rig, changed(rig, "left", change()):
        if fault:
            rig.fault(fault, node="left")
        runs(rig, 0.5)
        ORDERS[order](rig)
        assert runs(rig, to_seconds(TAKEN_WITHIN) + 1.0) <= to_seconds(TAKEN_WITHIN)
        assert speed(rig) < 0.01


@pytest.mark.long(beside="test_whatever_a_drive_and_its_bus_do_it_stops_in_time")
@every("lie", OF_A_GATEWAY)
@every("order", ORDERS)
def test_a_gateway_that_lies_keeps_no_stop(lie: str, order: str) -> None:
    with driving("rars+serial") as rig, changed(rig, "left", on_the_line(OF_A_GATEWAY[lie]())):
        runs(rig, 0.1)
        ORDERS[order](rig)
        assert runs(rig, to_seconds(TAKEN_WITHIN) + 1.0) <= to_seconds(TAKEN_WITHIN)
        assert speed(rig) < 0.01
