"""Start-up: four drives found, checked, set up, enabled; what is missing or refuses is named."""

from collections.abc import Callable
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.bridge import Bridge, Life
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robots.rars import ROBOT_TYPE
from firmware_bridge.units import MILLISECOND

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

# The set-up of node 1 (left wheel) as bytes, computed by hand from the object dictionary (EDS of the 70/10)
# and the mapping procedure of CiA 301; the heartbeat consumer has the form recorded as
# `23 16 10 01 D0 07 01 00` (node 1, 2000 ms) in a driver used with EPOS2 drives.
LEFT_WHEEL = """
23 00 14 01 01 02 00 80
2f 00 16 00 00 00 00 00
23 00 16 01 20 00 85 60
2f 00 16 00 01 00 00 00
2f 00 14 02 ff 00 00 00
23 00 14 01 01 02 00 00
23 01 14 01 01 03 00 80
23 02 14 01 01 04 00 80
23 03 14 01 01 05 00 80
2f 03 16 00 00 00 00 00
23 03 16 01 10 00 40 60
23 03 16 02 20 00 ff 60
2f 03 16 00 02 00 00 00
2f 03 14 02 ff 00 00 00
23 03 14 01 01 05 00 00
23 00 18 01 81 01 00 c0
2f 00 1a 00 00 00 00 00
23 00 1a 01 10 00 41 60
2f 00 1a 00 01 00 00 00
2f 00 18 02 ff 00 00 00
2b 00 18 03 0a 00 00 00
23 00 18 01 81 01 00 40
23 01 18 01 81 02 00 c0
2f 01 1a 00 00 00 00 00
23 01 1a 01 10 00 41 60
23 01 1a 02 20 00 64 60
23 01 1a 03 10 00 27 20
2f 01 1a 00 03 00 00 00
2f 01 18 02 01 00 00 00
2b 01 18 03 0a 00 00 00
23 01 18 01 81 02 00 40
23 02 18 01 81 03 00 c0
23 03 18 01 81 04 00 c0
2b 17 10 00 64 00 00 00
23 16 10 01 c8 00 64 00
2b 07 60 00 03 00 00 00
""".strip().splitlines()


def downloads(bench: "Bench", node: int) -> list[str]:
    """The bridge's SDO downloads to a node, without the controlword that takes the power off first."""
    frames = [payload for _, payload in bench.sent(0x600 + node)]
    return [frame for frame in frames if frame[0] == "2" and frame[3:8] != "40 60"]


def test_four_drives_are_found_set_up_and_enabled(started: "Bench") -> None:
    assert {drive.state for drive in started.drives.values()} == {PowerState.OPERATION_ENABLED}
    assert started.bridge.failure is None


def test_the_left_wheel_is_set_up_with_these_bytes(started: "Bench") -> None:
    assert downloads(started, 1)[: len(LEFT_WHEEL)] == LEFT_WHEEL


def test_nothing_is_written_before_every_identity_is_known(started: "Bench") -> None:
    frames = [(p.address, p.payload) for _, sender, p in started.frames if sender == "bridge"]
    first = next(i for i, (a, p) in enumerate(frames) if 0x601 <= a <= 0x604 and p[0] >> 5 == 1)
    requested = {a for a, p in frames[:first] if p[1:4] == bytes.fromhex("181002")}
    assert requested == {0x601, 0x602, 0x603, 0x604}


def test_nothing_gets_power_before_every_drive_is_set_up(bench: "Bench") -> None:
    bench.drives["lift"].refuses[at.POSITION_D] = AbortCode.TOO_HIGH
    bench.runs(3)
    assert bench.bridge.phase is Life.FAILED
    assert all(drive.words == [] for drive in bench.drives.values())


def test_a_recorded_walk_to_operation_enabled(started: "Bench") -> None:
    # The words recorded from a real maxon drive: 06 00, 07 00, 0F 00.
    assert [payload for _, payload in started.sent(0x501)][:3] == [
        "06 00 00 00 00 00",
        "07 00 00 00 00 00",
        "0f 00 00 00 00 00",
    ]


def test_the_heartbeat_comes_every_50_ms_once_it_has_listened(started: "Bench") -> None:
    beats = started.sent(0x764)
    assert {payload for _, payload in beats} == {"05"}
    assert len(beats) == 26, "it listens for 200 ms first"
    assert all(
        abs(later[0] - earlier[0] - 50 * MILLISECOND) < MILLISECOND for earlier, later in pairwise(beats)
    )


def test_limits_and_modes_reach_the_drive(started: "Bench") -> None:
    steer, left = started.drives["steer"].memory, started.drives["left"].memory
    assert left[od.MODE] == b"\x03"
    assert steer[od.MODE] == b"\x01"
    assert left[at.OUTPUT_CURRENT_LIMIT] == (20_000).to_bytes(2, "little")
    assert left[od.QUICK_STOP_DECELERATION] == (5_400).to_bytes(4, "little")
    low = int.from_bytes(steer[od.MIN_POSITION_LIMIT], "little", signed=True)
    high = int.from_bytes(steer[od.MAX_POSITION_LIMIT], "little", signed=True)
    # 60 degrees are 39.97 mm of rack, 2.665 rad of the pinion, 134.9 kqc; 4000 qc following error beyond.
    assert high == -low == pytest.approx(134_860 + 4_000, abs=100)


@pytest.mark.parametrize(
    ("break_it", "failure"),
    [
        (
            lambda drive: setattr(drive, "silent", True),
            "no answer to SDO upload 0x1000 within 2000 ms (expected device type 0x00020192)",
        ),
        (
            lambda drive: drive.memory.__setitem__(od.VENDOR_ID, bytes.fromhex("92010000")),
            "SDO upload 0x1018:01 gave 0x00000192 (expected vendor 0x000000FB)",
        ),
        (
            lambda drive: drive.memory.__setitem__(od.PRODUCT_CODE, bytes.fromhex("00002262")),
            "SDO upload 0x1018:02 gave 0x62220000 (expected product code 0x64200000)",
        ),
        (
            lambda drive: drive.refuses.__setitem__(Address(0x1602, 1), AbortCode.NOT_MAPPABLE),
            (
                "SDO download 0x1602:01 was refused with 0x06040041 object cannot be mapped to this PDO "
                "(writing PDO 0x1402 entry 1 0x60400010)"
            ),
        ),
        (
            lambda drive: drive.forgets.add(od.CONSUMER_HEARTBEAT_1),
            "SDO upload 0x1016:01 gave 0x00000000 (expected heartbeat consumer 0x006400C8)",
        ),
        (
            lambda drive: drive.forgets.add(od.PROFILE_DECELERATION),
            "SDO upload 0x6084 gave 0x00000000 (expected profile deceleration 0x0000C350)",
        ),
        (
            lambda drive: drive.stuck_in.add(PowerState.READY_TO_SWITCH_ON),
            (
                "it stayed in 'ready to switch on' for 1000 ms after controlword 0x0007 "
                "(expected 'operation enabled', statusword 0x8321)"
            ),
        ),
    ],
    ids=["silent", "vendor", "product", "refused", "heartbeat", "deceleration", "stuck"],
)
def test_a_drive_that_is_missing_or_refuses_is_named(
    bench: "Bench", break_it: Callable[[Any], None], failure: str
) -> None:
    break_it(bench.drives["steer"])
    bench.runs(4)
    assert bench.bridge.phase is Life.FAILED
    failure = f"node 3 (steering): {failure}"
    assert bench.bridge.failure == failure
    assert failure[:60] in bench.reported()
    assert all(drive.state is not PowerState.OPERATION_ENABLED for drive in bench.drives.values())


def test_all_missing_drives_are_named_at_once(bench: "Bench") -> None:
    for name in ("left", "lift"):
        bench.drives[name].silent = True
    bench.runs(4)
    assert [part.split(":")[0] for part in str(bench.bridge.failure).split("; ")] == [
        "node 1 (left rear wheel)",
        "node 4 (scissor lift)",
    ]


def test_a_drive_that_boots_late_is_waited_for(bench: "Bench") -> None:
    drive = bench.drives["right"]
    drive.silent = True
    bench.runs(1.2)
    drive.silent = False
    bench.inject("right", drive.boots())
    bench.runs(1.5)
    assert bench.bridge.phase is Life.RUNNING


def test_a_drive_that_restarts_while_it_is_set_up_is_named(bench: "Bench") -> None:
    bench.runs(0.23)
    bench.inject("lift", bench.drives["lift"].boots())
    bench.runs(1)
    assert bench.bridge.failure == "node 4 (scissor lift): it restarted by itself and lost its set-up"


def test_a_drive_that_still_has_power_is_stopped_first(bench: "Bench") -> None:
    drive = bench.drives["left"]
    drive.state = PowerState.OPERATION_ENABLED
    bench.starts()
    words = [raw.hex(" ") for address, raw in drive.written if address == od.CONTROLWORD]
    assert words == ["0b 00", "00 00"]


def test_a_drive_that_does_not_stop_turning_is_named(bench: "Bench") -> None:
    drive = bench.drives["left"]
    drive.state = PowerState.OPERATION_ENABLED
    drive.memory[at.VELOCITY_AVERAGED] = (-321).to_bytes(4, "little", signed=True)
    bench.runs(4)
    assert bench.bridge.failure == (
        "node 1 (left rear wheel): the motor still turns with -321 rpm 3 s after a quick stop"
    )
    bench.runs(2)
    assert drive.state is PowerState.SWITCH_ON_DISABLED, "it was found with power, and is not left with it"
    assert drive.memory[od.CONSUMER_HEARTBEAT_1] == bytes(4), "so its watch may end"


def test_a_fault_from_before_is_reset(bench: "Bench") -> None:
    bench.drives["steer"].state = PowerState.FAULT
    bench.starts()
    assert "80 00" in [payload[:5] for _, payload in bench.sent(0x403)]


def test_requests_wait_until_the_drives_are_ready(bench: "Bench") -> None:
    bench.runs(0.02)
    assert bench.arms() == 1
    assert "the drives are being set up" in bench.reported()


def test_after_a_failure_arming_is_denied_with_the_failure(bench: "Bench") -> None:
    bench.drives["steer"].silent = True
    bench.runs(3)
    assert bench.arms() == 2
    assert "no answer to SDO upload 0x1000" in bench.reported()


def test_a_bridge_that_never_woke_ends_at_once(robot: AnyRobot) -> None:
    bridge = Bridge(robot, ROBOT_TYPE)
    assert bridge.stop(0).sent == ()
    assert bridge.finished


def test_a_fault_that_cannot_be_reset_is_named_with_its_cause(bench: "Bench") -> None:
    drive = bench.drives["steer"]
    drive.state = PowerState.FAULT
    drive.stuck_in.add(PowerState.FAULT)
    drive.memory[Address(0x1003, 1)] = bytes.fromhex("20810000")
    bench.runs(3)
    assert bench.bridge.failure == (
        "node 3 (steering): it stayed in 'fault' for 1000 ms after controlword 0x0080 "
        "(expected 'operation enabled', statusword 0x8308); fault 0x8120, CAN error passive"
    )


def test_a_bridge_that_begins_in_a_mode_leaves_its_dead_drive_alone_and_arms(
    bench_with: "Callable[[Bridge], Bench]", robot: AnyRobot
) -> None:
    bench = bench_with(Bridge(robot, ROBOT_TYPE, mode="left_failed"))
    bench.drives["left"].silent = True
    bench.runs(3)
    assert bench.bridge.failure is None
    assert bench.bridge.phase is Life.RUNNING
