"""Frames of a second controller on a CAN link, and their effect in time, at both edges."""

from typing import Final

import pytest

from firmware_bridge.canopen_drive.driver.can_link import REMEMBERED
from firmware_bridge.drivers.all_drivers import all_drivers_of
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.epos2.driver.can_link_drivers import can_link_drivers
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds

LINK: Final = "drives"
ROBOT: Final = find("rars")
RECEIVED: Final[Nanoseconds] = 7 * MILLISECOND


def receives(address: int, payload: bytes = b"") -> LinkDrivers:
    link_drivers = can_link_drivers(ROBOT, LINK)
    assert link_drivers.link.receive(Packet(LINK, address, payload), RECEIVED) == ()
    return link_drivers


@pytest.mark.parametrize(
    ("address", "what"),
    [
        (0x000, "a network command: 000#"),
        (0x080, "SYNC: 080#"),
        (0x764, "the heartbeat of this bridge, node 100: 764#"),
        (0x501, "node 1 (left rear wheel) set-points: 501#"),
        (0x502, "node 2 (right rear wheel) set-points: 502#"),
        (0x403, "node 3 (steering) set-points: 403#"),
        (0x404, "node 4 (scissor lift) set-points: 404#"),
    ],
)
def test_what_only_the_master_of_these_drives_sends(address: int, what: str) -> None:
    link = receives(address).link
    assert link.master(RECEIVED) == f"someone else sends {what}"
    assert link.master(RECEIVED + REMEMBERED - 1) is not None
    assert link.master(RECEIVED + REMEMBERED) is None


@pytest.mark.parametrize(
    "address",
    [
        *(0x081, 0x100, 0x181, 0x281, 0x581, 0x601, 0x701, 0x763, 0x765),
        *(0x401, 0x402, 0x503, 0x504, 0x405, 0x505),
        *(0x8000_0000, 0x4000_0080, 0x8000_0764),
    ],
)
def test_what_others_may_send(address: int) -> None:
    """Drives, other nodes, an engineer's requests; frames with flags are none of CANopen's."""
    assert receives(address).link.master(RECEIVED) is None


def test_it_listens_as_long_as_the_drives_would_and_a_serial_line_receives_no_one() -> None:
    assert can_link_drivers(ROBOT, LINK).link.listens_for == 200 * MILLISECOND
    (line,) = all_drivers_of(over_serial(ROBOT))
    assert (line.link.listens_for, line.link.master(0)) == (0, None)


@pytest.mark.parametrize(
    ("frame", "writes"),
    [
        ("2316100100000000", True),
        ("2B40600F00000000", True),
        ("2110100108000000", True),
        ("0D00000000000000", True),
        ("4041600000000000", False),
        ("6000000000000000", False),
        ("8016100100000605", False),
        ("C216100104000000", False),
        ("231610", False),
        ("", False),
    ],
    ids=[
        *("the watch", "controlword", "announced", "segment", "read", "read on", "abort", "block", "short"),
        "nothing",
    ],
)
@pytest.mark.parametrize("node", [1, 4])
def test_what_someone_else_writes_to_a_drive(node: int, frame: str, *, writes: bool) -> None:
    """Reading is free; a block transfer the drive does not know, nor what is cut short."""
    link_drivers = receives(0x600 + node, bytes.fromhex(frame))
    reported = {Epos2Axis.of(driver.axis).node: driver.feedback.rewritten for driver in link_drivers.drivers}
    assert reported == {**dict.fromkeys(range(1, 5), ""), **({node: f"60{node}#{frame}"} if writes else {})}
