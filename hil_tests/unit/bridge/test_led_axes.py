"""Axes that follow another one between the cycles: when they are commanded again, and when not."""

import struct
from typing import TYPE_CHECKING, Final

from firmware_bridge.bridge.led_axes import EVERY
from firmware_bridge.motion import davis
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.bridge.bench import driving

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

BASE: Final = find("rars").geometry.base
STEER: Final = 0x383
WHEELS: Final = [0x201, 0x501, 0x202, 0x502]
QC_PER_RAD: Final = 2_000 * 159 / 6.283185307


def comes(bench: "Bench", angle: float, later_ms: int) -> list[Packet]:
    """Return what the bridge sends to the drives when the steering's position comes."""
    counter = round(davis.pinion_from_steer(BASE, angle) * QC_PER_RAD)
    packet = Packet("drives", STEER, struct.pack("<i", counter))
    sent = bench.bridge.receive(packet, bench.now + later_ms * MILLISECOND).sent
    return [one for one in sent if one.link == "drives"]


def rpm(packets: list[Packet], address: int) -> int:
    (payload,) = (one.payload for one in packets if one.address == address)
    value: int = struct.unpack_from("<i", payload, 2)[0]
    return value


def test_a_position_between_two_cycles_commands_both_wheels_by_its_angle(armed: "Bench") -> None:
    driving(armed, 0.3)
    sent = comes(armed, 0.3, 20)
    assert [one.address for one in sent] == WHEELS
    ratio = (1.0 + 0.2 * davis.curvature(BASE, 0.3)) / (1.0 - 0.2 * davis.curvature(BASE, 0.3))
    assert abs(rpm(sent, 0x502) / rpm(sent, 0x501) / ratio - 1.0) < 1e-3


def test_positions_that_come_without_end_are_answered_every_few_milliseconds(armed: "Bench") -> None:
    driving(armed, 0.3)
    answered = [bool(comes(armed, 0.3, 20 + later)) for later in range(11)]
    assert answered == [later % (EVERY // MILLISECOND) == 0 for later in range(11)]


def test_a_position_that_jumps_leads_no_further_than_the_axis_can_go(armed: "Bench") -> None:
    """Two positions 10 ms apart at opposite ends: the lead of 10 ms adds 10 ms at the top speed."""
    driving(armed, 0.3)
    comes(armed, -0.9, 20)
    sent = comes(armed, 0.9, 30)
    pinion = davis.pinion_from_steer(BASE, 0.9) + 4.6 * 0.010
    furthest = davis.curvature(BASE, davis.steer_from_pinion(BASE, pinion))
    ratio = (1.0 + 0.2 * furthest) / (1.0 - 0.2 * furthest)
    assert rpm(sent, 0x502) / rpm(sent, 0x501) < ratio * 1.001


def test_wheels_whose_newest_set_point_is_a_stop_keep_it(armed: "Bench") -> None:
    driving(armed, 0.3)
    armed.drives["left"].silent = True
    armed.runs(1.0)
    sent = comes(armed, 0.3, 20)
    assert not [one for one in sent if one.address == 0x501]
    assert rpm(sent, 0x502) == 0


def test_a_frame_that_is_too_short_moves_nothing(armed: "Bench") -> None:
    driving(armed, 0.3)
    reaction = armed.bridge.receive(Packet("drives", STEER, b"\x00\x01"), armed.now + 20 * MILLISECOND)
    assert [one for one in reaction.sent if one.link == "drives"] == []
