"""SDO writes that a bridge may send, each bound crossed by one, and the abort that leaves instead."""

import math
from collections.abc import Sequence
from typing import Final

import pytest

from firmware_bridge.canopen_drive.driver.setup import farewell
from firmware_bridge.families.epos2.driver.product import configuration
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2DigitalOutput, Epos2Link
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot
from hil_tests.safety.guard_bench import LINK, Bench, aborted, frame, raw, status, write
from hil_tests.safety.guard_robots import RARS, AnAxis, robot_with

STEER_END: Final = 134_953
"""60 degrees: rack 40.0 mm (4.7), 2.666 rad of pinion (4.8), 159 times 2000 quadcounts a turn."""
LIFT_END: Final = 2_890_879
"""86.7 mm of screw, 57.8 turns of 1.5 mm, 25 times 2000 quadcounts a turn."""

# What may be written over SDO: object, sub-index, bytes, values that may, values just beyond.
FOLLOWING: Final = 4_000
WRITES: Final = (
    (1, 0x1017, 0, 2, (100,), (99, 101, 0)),
    (1, 0x1016, 1, 4, (100 << 16 | 200, 0), (100 << 16 | 201, 100 << 16 | 199, 99 << 16 | 200, 1)),
    (1, 0x6007, 0, 2, (3,), (0, 1, 2, 4)),
    (1, 0x605E, 0, 2, (2,), (0, 1, 3, 0xFFFF)),
    (1, 0x1003, 0, 1, (0,), (1,)),
    (1, 0x6040, 0, 2, (0x0000, 0x0002, 0x000B), (0x0001, 0x0006, 0x0007, 0x000F, 0x003F, 0x0080, 0x010F)),
    (1, 0x6402, 0, 2, (1,), (0, 2, 10)),
    (1, 0x2210, 1, 4, (500,), (499, 501)),
    (1, 0x6410, 1, 2, (0, 10_000), (10_001,)),
    (1, 0x6410, 2, 2, (0, 20_000), (20_001,)),
    (1, 0x6410, 5, 2, (1, 40), (0, 41)),
    (1, 0x6410, 4, 4, (1, 4_000), (0, 4_001)),
    (1, 0x607F, 0, 4, (1, 4_000), (0, 4_001)),
    (1, 0x6065, 0, 4, (1, 20_000), (0, 20_001, 2**32 - 1)),
    (1, 0x6060, 0, 1, (3,), (1, 2, 4, 6, 0xFE, 0xFF)),
    (3, 0x6060, 0, 1, (1,), (0, 2, 3, 0xFF)),
    (1, 0x6086, 0, 2, (0,), (1,)),
    (1, 0x6081, 0, 4, (1, 4_000), (0, 4_001)),
    (3, 0x6081, 0, 4, (1, 6_984), (0, 6_985)),
    (4, 0x6081, 0, 4, (1, 6_994), (0, 6_995)),
    (1, 0x6083, 0, 4, (1, 5_700), (0, 5_701)),
    (1, 0x6084, 0, 4, (5_700,), (5_699, 5_701)),
    (1, 0x6085, 0, 4, (1_850, 5_400), (1_849, 5_401)),
    (3, 0x6085, 0, 4, (50_000,), (49_999, 50_001)),
    (3, 0x607D, 1, 4, (-STEER_END - FOLLOWING, STEER_END + FOLLOWING), (-STEER_END - FOLLOWING - 1,)),
    (3, 0x607D, 2, 4, (-STEER_END - FOLLOWING, STEER_END + FOLLOWING), (STEER_END + FOLLOWING + 1,)),
    (4, 0x607D, 1, 4, (-FOLLOWING, LIFT_END + FOLLOWING), (-FOLLOWING - 1, LIFT_END + FOLLOWING + 1)),
    # Receive PDOs: the wheels' fourth and the position axes' third carry set-points, the wheels' first their
    # quick stop deceleration; the others are off.
    (1, 0x1400, 1, 4, (0x8000_0201, 0x201), (0x202, 0x301)),
    (1, 0x1600, 0, 1, (0, 1), (2, 8)),
    (1, 0x1600, 1, 4, (0x6085_0020,), (0x6083_0020, 0x6084_0020, 0x60FF_0020)),
    *((1, 0x1400 + n, 1, 4, (0x8000_0201 + 0x100 * n,), (0x201 + 0x100 * n,)) for n in (1, 2)),
    (1, 0x1403, 1, 4, (0x8000_0501, 0x501), (0x502, 0x8000_0502, 0x500)),
    (3, 0x1402, 1, 4, (0x8000_0403, 0x403), (0x404, 0x503)),
    *((3, 0x1400 + n, 1, 4, (0x8000_0203 + 0x100 * n,), (0x203 + 0x100 * n,)) for n in (0, 1, 3)),
    (1, 0x1403, 2, 1, (1, 255), (0, 2, 253, 254)),
    (1, 0x1603, 0, 1, (0, 2), (1, 3, 8)),
    (1, 0x1603, 1, 4, (0x6040_0010,), (0x6060_0008, 0)),
    (1, 0x1603, 2, 4, (0x60FF_0020,), (0x607A_0020, 0x6083_0020)),
    (3, 0x1602, 2, 4, (0x607A_0020,), (0x60FF_0020,)),
    # Transmit PDOs carry what they like under their own identifiers; the first two begin with the statusword.
    *(
        (2, 0x1800 + n, 1, 4, (0x4000_0182 + 0x100 * n, 0xC000_0182 + 0x100 * n), (0x182 + 0x100 * n, 0))
        for n in range(4)
    ),
    *((2, 0x1800 + n, 2, 1, (1, 255), (0, 2, 254)) for n in range(4)),
    *((2, 0x1800 + n, 3, 2, (0, 10, 0xFFFF), ()) for n in range(4)),
    *((2, 0x1A00 + n, 0, 1, (0, 3, 8), (9,)) for n in range(4)),
    *((2, 0x1A00 + n, 1, 4, (0x6041_0010,), (0, 0x6041_0008, 0x6064_0020)) for n in (0, 1)),
    *((2, 0x1A00 + n, 1, 4, (0, 0x6041_0010, 2**32 - 1), ()) for n in (2, 3)),
    (2, 0x1A01, 2, 4, (0x6064_0020,), (0, 0x6041_0010, 0x6062_0020)),
    (2, 0x1A00, 2, 4, (0, 2**32 - 1), ()),
    *((2, 0x1A01, entry, 4, (0, 2**32 - 1), ()) for entry in range(3, 9)),
    *((2, 0x1A03, entry, 4, (0, 2**32 - 1), ()) for entry in range(1, 9)),
)
GAINS: Final = (
    (0x60F6, 1, "current_p"), (0x60F6, 2, "current_i"), (0x60F9, 1, "velocity_p"), (0x60F9, 2, "velocity_i"),
    (0x60F9, 4, "velocity_feedforward"), (0x60F9, 5, "acceleration_feedforward"),
    (0x60FB, 1, "position_p"), (0x60FB, 2, "position_i"), (0x60FB, 3, "position_d"),
    (0x60FB, 4, "position_velocity_feedforward"), (0x60FB, 5, "position_acceleration_feedforward"),
)  # fmt: skip


def with_ramps(robot: AnyRobot, **ramps: int) -> AnyRobot:
    """Return a robot whose drives have these accelerations."""
    axes = []
    for axis in robot.axes:
        profile = Epos2Axis.of(axis).profile.model_copy(update=ramps)
        axes.append(
            axis.model_copy(update={"settings": axis.settings.model_copy(update={"profile": profile})})
        )
    return robot.model_copy(update={"axes": tuple(axes)})


@pytest.mark.parametrize(("node", "index", "subindex", "size", "may", "beyond"), WRITES)
def test_an_object_may_be_written_within_its_bounds(
    bench: Bench,
    node: int,
    index: int,
    subindex: int,
    *,
    size: int,
    may: Sequence[int],
    beyond: Sequence[int],
) -> None:
    # The last write here, the end of the watch, needs a drive that has reported that it has no power.
    bench.receives(status(node, 0x0140))
    for value in may:
        packet = write(node, index, subindex, raw(value, size))
        assert bench.states(packet) == (packet,)
    for value in beyond:
        reason, sent = bench.refuses(write(node, index, subindex, raw(value, size)))
        assert sent == aborted(node, index, subindex)
        assert f"0x{index:04X}" in reason
        assert "allowed is" in reason
    for wrong in {1, 2, 3, 4} - {size}:
        reason, sent = bench.refuses(write(node, index, subindex, bytes(wrong)))
        assert f"written with {wrong} bytes, it has {size}" in reason
        assert sent == aborted(node, index, subindex)


@pytest.mark.parametrize(
    ("packet", "reason"),
    [
        (write(1, 0x6083, 0, raw(5_701, 4)), "0x6083 set to 5701, allowed is 1 to 5700"),
        (write(1, 0x6060, 0, raw(1, 1)), "0x6060 set to 1, allowed is 3"),
        (write(1, 0x1403, 2, raw(2, 1)), "0x1403:02 set to 2, allowed is 1 or 255"),
    ],
    ids=str,
)
def test_a_refused_write_is_reported_with_its_bounds(bench: Bench, packet: Packet, reason: str) -> None:
    assert bench.refuses(packet)[0] == reason


@pytest.mark.parametrize(
    ("index", "may", "beyond"),
    [
        (0x6083, (1, 1_000), (0, 1_001, 2_000, 3_000)),
        (0x6084, (2_000,), (1_000, 1_999, 2_001, 3_000)),
        (0x6085, (3_000,), (1_000, 2_000, 2_399, 3_001)),
    ],
)
def test_acceleration_deceleration_and_quick_stop_have_a_bound_each(
    robot: AnyRobot, index: int, may: tuple[int, ...], beyond: tuple[int, ...]
) -> None:
    bench = Bench(
        with_ramps(
            robot,
            acceleration_rpm_s=1_000,
            deceleration_rpm_s=2_000,
            quick_stop_rpm_s=3_000,
            quick_stop_least_rpm_s=2_400,
        )
    )
    for node in (1, 2, 3, 4):
        for value in may:
            packet = write(node, index, 0, raw(value, 4))
            assert bench.states(packet) == (packet,)
        for value in beyond:
            assert f"0x{index:04X} set to {value}, " in bench.refuses(write(node, index, 0, raw(value, 4)))[0]


@pytest.mark.parametrize(("index", "subindex", "name"), GAINS)
def test_gains_are_those_of_the_robot_file(robot: AnyRobot, index: int, subindex: int, name: str) -> None:
    for axis in robot.axes:
        bench = Bench(robot)
        gain = getattr(Epos2Axis.of(axis).gains, name)
        packet = write(Epos2Axis.of(axis).node, index, subindex, raw(gain, 2))
        assert bench.states(packet) == (packet,)
        for other in (gain + 1, gain - 1):
            assert bench.refuses(write(Epos2Axis.of(axis).node, index, subindex, raw(other, 2)))[
                1
            ] == aborted(Epos2Axis.of(axis).node, index, subindex)


@pytest.mark.parametrize(
    ("index", "subindex"),
    [
        (0x607A, 0), (0x60FF, 0), (0x2062, 0), (0x206B, 0), (0x2030, 0), (0x1010, 1), (0x1011, 1),
        (0x2000, 0), (0x1014, 0), (0x1016, 2), (0x60C5, 0), (0x6098, 0), (0x607D, 1), (0x607D, 2),
        (0x1404, 1), (0x1600, 2), (0x1601, 1), (0x1603, 3), (0x1804, 1), (0x1A00, 9), (0x6040, 1),
    ],
)  # fmt: skip
def test_no_other_object_may_be_written(bench: Bench, index: int, subindex: int) -> None:
    # Node 1 is a wheel: position limits are none of its business.
    reason, sent = bench.refuses(write(1, index, subindex, bytes(4)))
    assert reason.endswith("is not an object that may be written")
    assert sent == aborted(1, index, subindex)


@pytest.mark.parametrize(
    ("payload", "reason"),
    [
        ("2017100002000000", "SDO command 0x20 is not listed"),
        ("2117100002000000", "SDO command 0x21 is not listed"),
        ("2217100064000000", "SDO command 0x22 is not listed"),
        ("3317100064000000", "SDO command 0x33 is not listed"),
        ("0064000000000000", "SDO command 0x00 is not listed"),
        ("0b64000000000000", "SDO command 0x0B is not listed"),
        ("c017100000000000", "SDO command 0xC0 is not listed"),
        ("a317100000000000", "SDO command 0xA3 is not listed"),
        ("e317100000000000", "SDO command 0xE3 is not listed"),
        ("40416000000000", "an SDO request of 7 bytes"),
        ("404160", "an SDO request of 3 bytes"),
        ("", "an SDO request of 0 bytes"),
    ],
)
def test_other_services_are_answered_with_an_abort(bench: Bench, payload: str, reason: str) -> None:
    packet = frame(0x602, payload)
    reported, sent = bench.refuses(packet)
    assert reported == reason
    assert sent == (
        Packet(LINK, 0x602, b"\x80" + packet.payload[1:4].ljust(3, b"\0") + bytes.fromhex("00000008")),
    )


def test_an_axis_of_speed_with_travel_may_have_its_drive_s_position_limits_set() -> None:
    bench = Bench(
        robot_with((AnAxis("one", 1, LINK), AnAxis("two", 2, LINK, travel=(-1.0, 2.0), ratio=math.tau)))
    )
    for node, subindex in ((2, 1), (2, 2)):
        for value in (-2_000 - 20_000, 4_000 + 20_000):
            packet = write(node, 0x607D, subindex, raw(value, 4))
            assert bench.states(packet) == (packet,)
        for value in (-2_001 - 20_000, 4_001 + 20_000):
            bench.refuses(write(node, 0x607D, subindex, raw(value, 4)))
    bench.refuses(write(1, 0x607D, 1, bytes(4)))


OUTPUT_WRITES: Final = (
    (0x2079, 1, (15,), (0, 1, 2, 14, 16)),
    (0x2079, 3, (13,), (2, 12, 14, 15)),
    (0x2078, 1, (0x0000, 0x8000, 0x2000, 0xA000), (0x4000, 0x0004, 0x0001, 0xE000, 0xFFFF)),
    (0x2078, 2, (0x0000, 0x8000, 0x2000, 0xA000), (0x4000, 0x0004, 0x0001, 0xE000, 0xFFFF)),
)


@pytest.mark.parametrize(("index", "subindex", "may", "beyond"), OUTPUT_WRITES)
def test_outputs_that_the_robot_file_lists_may_be_switched_and_no_others(
    index: int, subindex: int, may: Sequence[int], beyond: Sequence[int]
) -> None:
    axes = (AnAxis("one", 1, LINK), AnAxis("two", 2, LINK))
    bench = Bench(robot_with(axes, outputs=(("two", 1), ("two", 3))))
    for value in may:
        packet = write(2, index, subindex, raw(value, 2))
        assert bench.states(packet) == (packet,)
        reason, sent = bench.refuses(write(1, index, subindex, raw(value, 2)))
        assert reason.endswith("is not an object that may be written")
        assert sent == aborted(1, index, subindex)
    for value in beyond:
        reason, sent = bench.refuses(write(2, index, subindex, raw(value, 2)))
        assert sent == aborted(2, index, subindex)
        assert reason.endswith("allowed is the bits 0xA000" if index == 0x2078 else f"allowed is {may[0]}")


@pytest.mark.parametrize(
    ("index", "subindex"), [(0x2078, 3), (0x2079, 2), (0x2079, 4), (0x2079, 5), (0x2070, 1)]
)
def test_other_pins_stay_as_they_are(index: int, subindex: int) -> None:
    bench = Bench(robot_with((AnAxis("one", 1, LINK),), outputs=(("one", 1), ("one", 3))))
    assert bench.refuses(write(1, index, subindex, bytes(2)))[1] == aborted(1, index, subindex)


def test_an_output_on_another_link_is_none_of_this_one() -> None:
    axes = (AnAxis("one", 1, LINK), AnAxis("two", 1, "other"))
    bench = Bench(robot_with(axes, outputs=(("two", 1),)))
    assert bench.refuses(write(1, 0x2078, 1, bytes(2)))[1] == aborted(1, 0x2078, 1)


@pytest.mark.parametrize(
    "robot", [RARS, robot_with((AnAxis("one", 1, LINK),), outputs=(("one", 1), ("one", 4)))]
)
def test_the_whole_set_up_of_every_drive_leaves_as_it_is(robot: AnyRobot) -> None:
    """Driver and guard share no code: what one writes the other must list."""
    bench = Bench(robot)
    for axis in robot.axes:
        outputs = [output for output in robot.outputs if Epos2DigitalOutput.of(output).axis == axis.name]
        bench.receives(status(Epos2Axis.of(axis).node, 0x0140))
        for row in (*configuration(axis, Epos2Link.of_link(robot, LINK), outputs), *farewell()):
            packet = write(Epos2Axis.of(axis).node, *row.address, row.raw)
            assert bench.states(packet) == (packet,), row
    assert bench.guard.refused == 0
