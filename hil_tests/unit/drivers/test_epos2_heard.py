"""What a drive tells, from frames recorded on buses with maxon drives, and from garbage."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge import robot as robots
from firmware_bridge.drivers.epos2_heard import Ear
from firmware_bridge.intent import NEVER_HEARD
from firmware_bridge.robot import Role
from firmware_bridge.units import MILLISECOND
from firmware_bridge.wire.cia402 import State

ROBOT = robots.find("rars")
AXIS = ROBOT.axis(Role.RIGHT_WHEEL)
CYCLE = 50 * MILLISECOND


@pytest.fixture
def ear() -> Ear:
    ear = Ear(AXIS)
    ear.knows_mapping = True
    return ear


def sample(position: int, statusword: int = 0x0737, current: int = 0) -> bytes:
    parts = ((statusword, 2), (position & 0xFFFF_FFFF, 4), (current & 0xFFFF, 2))
    return b"".join(value.to_bytes(size, "little") for value, size in parts)


@pytest.mark.parametrize(
    ("payload", "state"),
    [
        # Recorded enable sequence of a maxon drive, node 2 (github.com/machinekit/machinekit, issue 589).
        ("40 07", State.SWITCH_ON_DISABLED),
        ("21 07", State.READY_TO_SWITCH_ON),
        ("23 07", State.SWITCHED_ON),
        ("37 07", State.OPERATION_ENABLED),
        ("08 02", None),
    ],
)
def test_recorded_statuswords(ear: Ear, payload: str, state: State | None) -> None:
    ear.hear(0x182, bytes.fromhex(payload), 5)
    assert ear.heard.state is state
    assert ear.heard.operational


def test_a_recorded_emergency_names_the_fault(ear: Ear) -> None:
    # EPOS2 exoskeleton driver, at loss of power: code 0x3220, register 0x04, five zero bytes.
    ear.hear(0x082, bytes.fromhex("20 32 04 00 00 00 00 00"), 5)
    assert ear.heard.fault == 0x3220
    ear.hear(0x082, bytes(8), 6)
    assert ear.heard.fault == 0


def test_a_recorded_boot_up_means_the_set_up_is_lost(ear: Ear) -> None:
    ear.hear(0x182, bytes.fromhex("37 07"), 5)
    ear.hear(0x702, b"\0", 6)
    assert ear.heard.restarted
    assert ear.heard.state is None
    assert not ear.heard.operational


def test_a_heartbeat_in_pre_operational_makes_the_state_unknown(ear: Ear) -> None:
    ear.hear(0x182, bytes.fromhex("37 07"), 5)
    ear.hear(0x702, b"\x7f", 6)
    assert ear.heard.state is None
    ear.hear(0x702, b"\x05", 7)
    assert ear.heard.operational
    assert ear.heard.state is None


def test_a_heartbeat_alone_is_no_sample(ear: Ear) -> None:
    ear.hear(0x702, b"\x05", 7)
    assert ear.heard.heard_at == NEVER_HEARD


def test_position_current_and_the_mean_speed_between_two_syncs(ear: Ear) -> None:
    ear.synchronised(0)
    ear.hear(0x282, sample(1000), MILLISECOND)
    assert ear.heard.speed_rad_s == 0.0
    ear.synchronised(CYCLE)
    ear.hear(0x282, sample(3600, current=-250), CYCLE + 2 * MILLISECOND)
    # 2600 of 26 x 2000 quadcounts a turn in 50 ms: one turn of the wheel a second.
    assert ear.heard.speed_rad_s == pytest.approx(2.0 * math.pi)
    assert ear.heard.position_qc == 3600
    assert ear.heard.current_ma == -250
    assert ear.heard.sampled_at == CYCLE
    assert ear.heard.heard_at == CYCLE + 2 * MILLISECOND


def test_the_speed_across_the_counters_wrap(ear: Ear) -> None:
    ear.synchronised(0)
    ear.hear(0x282, sample(2**31 - 1300), 1)
    ear.synchronised(CYCLE)
    ear.hear(0x282, sample(-(2**31) + 1300), CYCLE + 1)
    assert ear.heard.speed_rad_s == pytest.approx(2.0 * math.pi)


def test_a_second_sample_of_one_sync_keeps_the_speed(ear: Ear) -> None:
    ear.synchronised(0)
    ear.hear(0x282, sample(0), 1)
    ear.synchronised(CYCLE)
    ear.hear(0x282, sample(2600), CYCLE + 1)
    ear.hear(0x282, sample(2601), CYCLE + 2)
    assert ear.heard.speed_rad_s == pytest.approx(2.0 * math.pi)


def test_after_a_restart_no_speed_is_made_up(ear: Ear) -> None:
    ear.synchronised(0)
    ear.hear(0x282, sample(500_000), 1)
    ear.hear(0x702, b"\0", 2)
    ear.knows_mapping = True
    ear.synchronised(CYCLE)
    ear.hear(0x282, sample(0), CYCLE + 1)
    assert ear.heard.speed_rad_s == 0.0


def test_process_data_of_an_earlier_mapping_is_not_believed() -> None:
    ear = Ear(AXIS)
    ear.hear(0x182, bytes.fromhex("37 07"), 5)
    ear.hear(0x282, sample(123), 6)
    assert ear.heard.state is None
    assert ear.heard.heard_at == NEVER_HEARD


@given(st.lists(st.tuples(st.integers(0, 0x7FF), st.binary(max_size=8), st.booleans()), max_size=40))
def test_no_frames_make_it_raise(frames: list[tuple[int, bytes, bool]]) -> None:
    ear = Ear(AXIS)
    ear.knows_mapping = True
    for now, (cob_id, payload, synchronised) in enumerate(frames):
        if synchronised:
            ear.synchronised(now)
        ear.hear(cob_id, payload, now)
    assert math.isfinite(ear.heard.speed_rad_s)
