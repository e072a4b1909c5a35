"""Feedback of a drive, from frames recorded on buses with maxon drives, and from garbage."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.driver.can_feedback import CanFeedback
from firmware_bridge.drivers.driver import Power
from firmware_bridge.families.epos2.driver.product import product
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.units import MILLISECOND
from hil_tests.unit.drivers.robots import RARS, with_axis

AXIS = RARS.axis("right_wheel")
CYCLE = 50 * MILLISECOND


@pytest.fixture
def feedback() -> CanFeedback:
    feedback = CanFeedback(AXIS, product(AXIS))
    feedback.expected = True
    return feedback


def sample(position: int, statusword: int = 0x0737, current: int = 0) -> bytes:
    parts = ((statusword, 2), (position & 0xFFFF_FFFF, 4), (current & 0xFFFF, 2))
    return b"".join(value.to_bytes(size, "little") for value, size in parts)


@pytest.mark.parametrize(
    ("payload", "state"),
    [
        # Recorded enable sequence of a maxon drive, node 2 (github.com/machinekit/machinekit, issue 589).
        ("40 07", PowerState.SWITCH_ON_DISABLED),
        ("21 07", PowerState.READY_TO_SWITCH_ON),
        ("23 07", PowerState.SWITCHED_ON),
        ("37 07", PowerState.OPERATION_ENABLED),
        ("08 02", None),
    ],
)
def test_recorded_statuswords(feedback: CanFeedback, payload: str, state: PowerState | None) -> None:
    feedback.receive(0x182, bytes.fromhex(payload), 5)
    assert feedback.state is state
    assert feedback.operational


def test_a_recorded_emergency_names_the_fault(feedback: CanFeedback) -> None:
    # EPOS2 exoskeleton driver, at loss of power: code 0x3220, register 0x04, five zero bytes.
    feedback.receive(0x082, bytes.fromhex("20 32 04 00 00 00 00 00"), 5)
    assert feedback.fault == 0x3220
    feedback.receive(0x082, bytes(8), 6)
    assert feedback.fault == 0


def test_a_recorded_boot_up_means_the_set_up_is_lost(feedback: CanFeedback) -> None:
    feedback.receive(0x182, bytes.fromhex("37 07"), 5)
    feedback.receive(0x702, b"\0", 6)
    assert feedback.restarted
    assert feedback.state is None
    assert not feedback.operational


def test_a_heartbeat_in_pre_operational_makes_the_state_unknown(feedback: CanFeedback) -> None:
    feedback.receive(0x182, bytes.fromhex("37 07"), 5)
    feedback.receive(0x702, b"\x7f", 6)
    assert feedback.state is None
    feedback.receive(0x702, b"\x05", 7)
    assert feedback.operational
    assert feedback.state is None


def test_a_heartbeat_alone_is_no_sample(feedback: CanFeedback) -> None:
    feedback.receive(0x702, b"\x05", 7)
    assert feedback.received_at == NEVER_RECEIVED


def test_position_current_and_the_mean_speed_between_two_syncs(feedback: CanFeedback) -> None:
    feedback.synchronized(0)
    feedback.receive(0x282, sample(1000), MILLISECOND)
    assert feedback.velocity == 0.0
    feedback.synchronized(CYCLE)
    feedback.receive(0x282, sample(3600, current=-250), CYCLE + 2 * MILLISECOND)
    # 2600 of 26 x 2000 quadcounts a turn in 50 ms: one turn of the wheel a second.
    assert feedback.velocity == pytest.approx(2.0 * math.pi)
    assert feedback.position_counts == 3600
    assert feedback.current == -250
    assert feedback.sampled_at == CYCLE
    assert feedback.received_at == CYCLE + 2 * MILLISECOND


def test_the_speed_across_the_counters_wrap(feedback: CanFeedback) -> None:
    feedback.synchronized(0)
    feedback.receive(0x282, sample(2**31 - 1300), 1)
    feedback.synchronized(CYCLE)
    feedback.receive(0x282, sample(-(2**31) + 1300), CYCLE + 1)
    assert feedback.velocity == pytest.approx(2.0 * math.pi)


def test_a_second_sample_of_one_sync_keeps_the_speed(feedback: CanFeedback) -> None:
    feedback.synchronized(0)
    feedback.receive(0x282, sample(0), 1)
    feedback.synchronized(CYCLE)
    feedback.receive(0x282, sample(2600), CYCLE + 1)
    feedback.receive(0x282, sample(2601), CYCLE + 2)
    assert feedback.velocity == pytest.approx(2.0 * math.pi)


def test_after_a_restart_no_speed_is_made_up(feedback: CanFeedback) -> None:
    feedback.synchronized(0)
    feedback.receive(0x282, sample(500_000), 1)
    feedback.receive(0x702, b"\0", 2)
    feedback.expected = True
    feedback.synchronized(CYCLE)
    feedback.receive(0x282, sample(0), CYCLE + 1)
    assert feedback.velocity == 0.0


def test_process_data_of_an_earlier_mapping_is_not_believed() -> None:
    feedback = CanFeedback(AXIS, product(AXIS))
    feedback.receive(0x182, bytes.fromhex("37 07"), 5)
    feedback.receive(0x282, sample(123), 6)
    assert feedback.state is None
    assert feedback.received_at == NEVER_RECEIVED


@given(st.lists(st.tuples(st.integers(0, 0x7FF), st.binary(max_size=8), st.booleans()), max_size=40))
def test_no_frames_make_it_raise(frames: list[tuple[int, bytes, bool]]) -> None:
    feedback = CanFeedback(AXIS, product(AXIS))
    feedback.expected = True
    for now, (cob_id, payload, synchronized) in enumerate(frames):
        if synchronized:
            feedback.synchronized(now)
        feedback.receive(cob_id, payload, now)
    assert math.isfinite(feedback.velocity)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("turns", [1, -1])
def test_the_position_counts_on_across_the_counters_wrap(direction: int, turns: int) -> None:
    """Two thousand turns of a counter that begins a step before its end, to either side."""
    feedback = CanFeedback(
        with_axis(AXIS, direction=direction), product(with_axis(AXIS, direction=direction))
    )
    feedback.expected = True
    start, step = turns * (2**31 - 5), turns * (2**30 + 7)
    feedback.synchronized(0)
    feedback.receive(0x282, sample(start), 1)
    for cycle in range(1, 9):
        feedback.synchronized(cycle * CYCLE)
        feedback.receive(0x282, sample(start + cycle * step), cycle * CYCLE + 1)
    public = feedback.published()
    assert feedback.position_counts == start + 8 * step
    assert public.position == pytest.approx(direction * (start + 8 * step) / (26 * 2000) * 2.0 * math.pi)
    assert math.copysign(1.0, public.velocity) == direction * turns


def test_after_a_restart_the_position_begins_again(feedback: CanFeedback) -> None:
    feedback.synchronized(0)
    feedback.receive(0x282, sample(2**31 - 10), 1)
    feedback.synchronized(CYCLE)
    feedback.receive(0x282, sample(-(2**31) + 10), CYCLE + 1)
    assert feedback.position_counts == 2**31 + 10
    feedback.receive(0x702, b"\0", CYCLE + 2)
    feedback.expected = True
    feedback.synchronized(2 * CYCLE)
    feedback.receive(0x282, sample(-7), 2 * CYCLE + 1)
    assert feedback.position_counts == -7


@given(st.lists(st.integers(-(2**31), 2**31 - 1), min_size=1, max_size=30), st.integers(-(2**31), 2**31 - 1))
def test_no_way_is_lost_while_a_step_is_below_half_the_counter(steps: list[int], start: int) -> None:
    feedback = CanFeedback(AXIS, product(AXIS))
    feedback.expected = True
    for cycle, way in enumerate((start, *steps)):
        feedback.synchronized(cycle * CYCLE)
        at = way if cycle == 0 else feedback.position_counts + way
        feedback.receive(0x282, sample(at), cycle * CYCLE + 1)
    assert feedback.position_counts == start + sum(steps)


@pytest.mark.parametrize("state", [None, *PowerState], ids=str)
def test_every_state_is_one_of_five_powers(feedback: CanFeedback, state: PowerState | None) -> None:
    feedback.state = state
    powers = {
        None: Power.UNKNOWN,
        PowerState.OPERATION_ENABLED: Power.ON,
        PowerState.QUICK_STOP_ACTIVE: Power.STOPPED,
        PowerState.FAULT: Power.FAULT,
        PowerState.FAULT_REACTION_ENABLED: Power.FAULT,
        PowerState.FAULT_REACTION_DISABLED: Power.FAULT,
    }
    public = feedback.published()
    assert public.power is powers.get(state, Power.OFF)
    assert public.text == ("" if state is None else state.title)


def test_what_everybody_may_know_is_in_si_units(feedback: CanFeedback) -> None:
    feedback.synchronized(0)
    feedback.receive(0x282, sample(0), 1)
    feedback.synchronized(CYCLE)
    feedback.receive(0x282, sample(2600, current=-250), CYCLE + 2)
    feedback.receive(0x082, bytes.fromhex("11 86 20 00 00 00 00 00"), CYCLE + 3)
    public = feedback.published()
    assert (public.axis, public.power, public.text) == ("right", Power.ON, "operation enabled")
    assert public.position == pytest.approx(0.1 * math.pi)
    assert public.velocity == pytest.approx(2.0 * math.pi)
    assert (public.current_a, public.fault) == (-0.25, "0x8611, following error larger than 0x6065")
    assert (public.sampled_at, public.received_at) == (CYCLE, CYCLE + 2)


def test_before_a_drive_has_sent_anything_nothing_is_known() -> None:
    public = CanFeedback(AXIS, product(AXIS)).published()
    assert (public.power, public.text, public.fault) == (Power.UNKNOWN, "", "")
    assert public.received_at == public.sampled_at == NEVER_RECEIVED


def test_bit_15_reports_that_the_zero_holds_until_it_was_gone_once(feedback: CanFeedback) -> None:
    for word, lost in (("37 87", False), ("37 07", True), ("37 87", True)):
        feedback.receive(0x182, bytes.fromhex(word), 5)
        assert feedback.published().reference_lost is lost
    feedback.reference_set(0)
    assert not feedback.published().reference_lost


def test_a_boot_up_loses_the_zero_whatever_bit_15_states_then(feedback: CanFeedback) -> None:
    feedback.receive(0x182, bytes.fromhex("37 87"), 5)
    feedback.receive(0x702, b"\0", 6)
    feedback.expected = True
    feedback.receive(0x182, bytes.fromhex("37 87"), 7)
    assert feedback.published().reference_lost


def test_while_the_counter_is_set_no_way_is_a_motion(feedback: CanFeedback) -> None:
    feedback.zeroing = True
    for cycle, counter in enumerate((0, 2_000_000, -2_000_000)):
        feedback.synchronized(cycle * CYCLE)
        feedback.receive(0x282, sample(counter), cycle * CYCLE + 1)
        assert (feedback.velocity, feedback.position_counts) == (0.0, counter)
    feedback.reference_set(777)
    feedback.synchronized(9 * CYCLE)
    feedback.receive(0x282, sample(800), 9 * CYCLE + 1)
    assert (feedback.velocity, feedback.position_counts) == (0.0, 800)


@pytest.mark.parametrize("direction", [1, -1])
def test_a_current_has_the_sign_of_the_axis_direction(direction: int) -> None:
    axis = AXIS.model_copy(update={"direction": direction})
    feedback = CanFeedback(axis, product(axis))
    feedback.expected = True
    feedback.synchronized(0)
    feedback.receive(0x282, sample(1_000, current=500), 1)
    assert feedback.published().current_a == pytest.approx(direction * 0.5)
