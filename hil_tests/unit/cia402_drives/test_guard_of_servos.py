"""The guard of CiA 402 drives: which frames pass, and that its arithmetic and the driver's agree.

Frames: CiA 301 for identifiers and SDO, CiA 402-2 for objects and Controlwords.
"""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.driver.can_feedback import CanFeedback
from firmware_bridge.canopen_drive.driver.scale import highest_speed, travel_of
from firmware_bridge.canopen_drive.driver.set_point import set_point
from firmware_bridge.canopen_drive.guard import bounds
from firmware_bridge.canopen_drive.guard.words import GuardedSetPoint
from firmware_bridge.drivers.driver import Position, Speed
from firmware_bridge.families.cia402.driver.product import configuration, product
from firmware_bridge.families.cia402.guard.product import can_rules, units
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from hil_tests.unit.cia402_drives.on_servos import rars

ROBOT = rars()
LINK = "drives"
WHEEL, STEERING = ROBOT.axes[0], ROBOT.axes[2]


def frame(text: str) -> Packet:
    head, _, tail = text.partition("#")
    return Packet(LINK, int(head, 16), bytes.fromhex(tail))


@pytest.mark.parametrize(
    "text",
    [
        "501#0F00840F0000",  # 3972 rpm
        "501#0F007CF0FFFF",  # -3972 rpm
        "501#0B0000000000",
        "403#3F0000000000",
        "601#2B5A600002000000",  # quick stop option 2
        "601#2B73600000000000",
        "601#2F60600003000000",
        "601#4041600000000000",
        "000#0101",
        "080#",
        "764#05",
    ],
)
def test_what_passes(text: str) -> None:
    assert can_rules(ROBOT, LINK).refuses(frame(text), 0) is None


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("501#0F00850F0000", "target 3973 rpm is not within -3972 to 3972 rpm"),
        ("403#3F0080841E00", "target 2000000 counts is not within -134953 to 134953 counts"),
        ("501#1F0000000000", "controlword 0x001F is not listed"),
        ("403#1F0000000000", "controlword 0x001F is not listed"),
        ("603#2B4060001F000000", "the drive has not reported that its homing moves nothing"),
        ("601#2B5A600005000000", "0x605A set to 5, allowed is 2"),
        ("601#2B5A600006000000", "0x605A set to 6, allowed is 2"),
        ("601#2B0760000000", "an SDO request of 6 bytes"),
        ("601#2B07600000000000", "0x6007 set to 0, allowed is 3"),
        ("601#2B736000D1070000", "0x6073 set to 2001, allowed is 0 to 2000"),
        ("601#23806000A10F0000", "0x6080 set to 4001, allowed is 1 to 4000"),
        ("601#2FC2600100000000", "0x60C2:01 set to 0, allowed is 1 to 255"),
        ("601#2F60600009000000", "0x6060 set to 9, allowed is 3"),
        ("603#237C600000000080", "0x607C set to -2147483648, allowed is -134953 to 134953"),
        ("601#2310100173617665", "0x1010:01 is not an object that may be written"),
        ("601#2B71600001000000", "0x6071 is not an object that may be written"),
        ("601#23FF600001000000", "0x60FF is not an object that may be written"),
        ("301#0F0000000000", "identifier 0x301 is not listed"),
    ],
)
def test_what_is_refused_and_why(text: str, why: str) -> None:
    assert can_rules(ROBOT, LINK).refuses(frame(text), 0) == why


def test_factors_are_written_as_the_robot_file_has_them_and_not_at_all_without() -> None:
    scaled = rars(("node = 3\n", "node = 3\nfactors = { encoder_counts = 500, feed = 2_000 }\n"))
    feed, other = frame("603#23926001D0070000"), frame("603#23926001D1070000")
    assert can_rules(ROBOT, LINK).refuses(feed, 0) == "0x6092:01 is not an object that may be written"
    assert can_rules(scaled, LINK).refuses(feed, 0) is None
    assert can_rules(scaled, LINK).refuses(other, 0) == "0x6092:01 set to 2001, allowed is 2000"


@pytest.mark.parametrize("axis", ROBOT.axes, ids=lambda axis: axis.name)
def test_each_row_of_the_set_up_passes(axis: Axis) -> None:
    rules = can_rules(ROBOT, LINK)
    requests = 0x600 + axis.settings.number
    for row in configuration(axis, ROBOT):
        if row.awaited:
            continue
        size = row.type.size
        specifier = 0x23 | (4 - size) << 2
        head = bytes((specifier, *row.address.index.to_bytes(2, "little"), row.address.subindex))
        packet = Packet(LINK, requests, (head + row.raw).ljust(8, b"\0"))
        assert rules.refuses(packet, 0) is None, row


SCALES = st.sampled_from((1.0, 10.0, 1000.0 / 3.0, 2000.0 / 60.0, 0.1))


def scaled(axis: Axis, scale: float, ratio: float, direction: int, counts: int) -> Axis:
    """The axis with other units, gear and mounting."""
    settings = axis.settings.model_copy(update={"speed_units_per_rpm": scale, "encoder_counts": counts})
    return axis.model_copy(update={"settings": settings, "ratio": ratio, "direction": direction})


@given(
    scale=SCALES,
    ratio=st.floats(0.5, 300.0),
    direction=st.sampled_from((1, -1)),
    counts=st.integers(16, 1_000_000),
    share=st.floats(-3.0, 3.0),
)
def test_no_set_point_of_the_driver_is_beyond_the_guards_bounds(
    *, scale: float, ratio: float, direction: int, counts: int, share: float
) -> None:
    """They share no code; the driver clips to the last unit that the guard lets through."""
    for axis, wanted in ((WHEEL, Speed(share * WHEEL.top_speed)), (STEERING, Position(share * 2.0))):
        one = scaled(axis, scale, ratio, direction, counts)
        feedback = CanFeedback(one, product(one))
        feedback.state = PowerState.OPERATION_ENABLED
        packet = set_point(one, feedback).frame_for(wanted)
        target = GuardedSetPoint(0, int.from_bytes(packet.payload[2:], "little", signed=True)).target
        allowed = bounds.targets(one, units(one))
        assert target in allowed
    wheel, steering = (scaled(axis, scale, ratio, direction, counts) for axis in (WHEEL, STEERING))
    assert highest_speed(wheel) <= bounds.highest_speed(wheel, units(wheel))
    travel = travel_of(steering)
    assert travel is not None
    assert tuple(travel) == bounds.ends(steering, units(steering))


def test_a_drive_that_was_on_before_the_bridge_is_not_referenced() -> None:
    """No boot-up message came: what it counts from is known to no one."""
    assert CanFeedback(STEERING, product(STEERING)).published().reference_lost
