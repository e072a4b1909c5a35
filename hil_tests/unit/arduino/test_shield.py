"""The motor shield to the register: bus times, the PWM chip, the half bridges, what the library writes."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from emulators.arduino_omni.shield.i2c import (
    GENERAL_CALL,
    Transfer,
    TransferResult,
    TransferSegment,
    read,
    write,
)
from emulators.arduino_omni.shield.motor_shield import share
from emulators.arduino_omni.shield.pca9685 import Pca9685, Wave, wave
from emulators.arduino_omni.shield.tb6612 import (
    COAST,
    Bridge,
    BridgeDuty,
    Thermal,
    bridge,
    limited,
    locked,
    on_resistance,
)
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, SECOND
from hil_tests.rows import every
from hil_tests.unit.arduino.master import ADDRESS, BIT, Master

# The bus


def test_a_channel_write_takes_the_time_of_its_bits() -> None:
    it = Master()
    assert it.write("26 00 00 00 08").acknowledged
    assert it.now == (1 + 6 * 9 + 1) * BIT == 560 * MICROSECOND
    assert (it.bus.bytes, it.bus.busy) == (6, it.now)


def test_no_one_there_is_reported_after_the_address() -> None:
    it = Master()
    assert not it.write("26 00 00 00 08", address=0x61).acknowledged
    assert it.now == (1 + 9 + 1) * BIT


def test_a_repeated_start_is_one_bit_and_no_stop() -> None:
    it = Master()
    result = it.do(Transfer((TransferSegment(ADDRESS, b"\0"), TransferSegment(ADDRESS, to_read=1))))
    assert result == TransferResult(acknowledged=True, read=b"\x11")
    assert it.now == (1 + 18 + 1 + 18 + 1) * BIT


def test_outputs_change_at_the_stop_and_not_before() -> None:
    it = Master().begin()
    for text in ("2A 00 00 00 00", "2E 00 10 00 00"):
        it.write(text)
    begun = it.now
    it.bus.begin(write(ADDRESS, bytes.fromhex("26 00 00 00 08")), begun)
    assert it.bus.due == begun + 560 * MICROSECOND
    assert it.bus.advance(it.bus.due - 1) is None
    assert it.shield.outputs(it.bus.due - 1)[0] == BridgeDuty(brake=4096)
    it.bus.advance(it.bus.due)
    assert it.shield.outputs(begun + 560 * MICROSECOND)[0] == BridgeDuty(cw=2048, brake=2048)


def test_with_och_each_byte_counts_at_its_own_time() -> None:
    it = Master().begin()
    it.write("01 0C")
    it.write("2E 00 10 00 00")
    begun = it.now
    it.bus.begin(write(ADDRESS, bytes.fromhex("26 00 00 00 08")), begun)
    assert it.bus.due == begun + 10 * BIT  # each byte
    it.bus.advance(begun + (1 + 5 * 9) * BIT)
    assert it.motors()[0] == BridgeDuty(brake=4096)
    it.bus.advance(begun + (1 + 6 * 9) * BIT)
    assert it.motors()[0] == BridgeDuty(cw=2048, brake=2048)


def test_a_master_that_is_reset_leaves_what_has_passed_and_it_counts_from_the_next_stop() -> None:
    it = Master().begin()
    it.write("2E 00 10 00 00")
    it.bus.begin(write(ADDRESS, bytes.fromhex("26 00 00 00 08 00 00 00 01")), it.now)
    it.now += (1 + 6 * 9) * BIT
    it.bus.abandon(it.now)
    assert it.bus.due == NEVER
    assert it.motors()[0] == BridgeDuty(brake=4096)
    it.write("00")
    assert it.motors()[0] == BridgeDuty(cw=2048, brake=2048)


# The PWM chip


def test_it_powers_up_asleep_with_every_channel_full_off() -> None:
    chip = Pca9685(ADDRESS)
    assert [chip.register(n) for n in (0, 1, 5, 0xFE)] == [0x11, 0x04, 0xE0, 0x1E]
    assert [chip.register(6 + 4 * n + 3) for n in range(16)] == [0x10] * 16
    assert chip.period == 4096 * 31 * SECOND // 25_000_000  # 200 Hz, nearly


@pytest.mark.parametrize(
    ("on", "off", "expected"),
    [
        (0, 0, Wave(0, 0)),
        (0, 2048, Wave(0, 2048)),
        (4095, 1, Wave(4095, 2)),
        (7, 7, Wave(7, 0)),
        (4096, 0, Wave(0, 4096)),
        (0, 4096, Wave(0, 0)),
        (4096, 4096, Wave(0, 0)),
        (0, 4095, Wave(0, 4095)),
    ],
)
def test_what_a_channel_does_by_its_registers(on: int, off: int, expected: Wave) -> None:
    assert wave(on, off) == expected


def test_the_pre_scale_is_taken_in_sleep_only_and_not_below_three() -> None:
    it = Master()
    it.write("FE 02")
    assert it.chip.pre_scale == 3
    it.write("00 00")
    it.write("FE 20")
    assert it.chip.pre_scale == 3


def test_sleep_stops_and_restart_goes_on_after_500_us() -> None:
    it = Master().begin()
    it.write("2E 00 10 00 00")
    it.write("26 00 00 00 08")
    it.write("00 31")
    assert it.chip.register(0) == 0xB1
    assert it.motors()[0] == COAST
    it.write("00 21")
    woken = it.now - BIT
    assert it.chip.register(0) == 0xA1
    assert it.chip.next_change(it.now) == woken + 500 * MICROSECOND
    it.write("00 A1")  # 290 us after: too early
    assert it.chip.register(0) == 0xA1
    it.now = woken + MILLISECOND
    assert it.motors()[0] == COAST
    it.write("00 21")  # a 0 has no effect
    assert it.chip.register(0) == 0xA1
    it.write("00 A1")
    assert it.chip.register(0) == 0x21
    assert it.motors()[0] == BridgeDuty(cw=2048, brake=2048)


def test_a_write_to_a_channel_ends_the_hold_too() -> None:
    it = Master().begin()
    it.write("2E 00 10 00 00")
    it.write("00 31")
    it.write("00 21")
    it.now += MILLISECOND
    assert it.motors()[0] == COAST
    it.write("26 00 00 00 08")
    assert it.chip.register(0) == 0x21
    assert it.motors()[0] == BridgeDuty(cw=2048, brake=2048)


def test_outputs_begin_500_us_after_sleep() -> None:
    it = Master()
    it.write("00 20")
    woken = it.now - BIT
    it.write("2E 00 10 00 00")  # over at 580 us
    assert it.shield.outputs(woken + 500 * MICROSECOND - 1)[0] == COAST
    assert it.shield.outputs(woken + 500 * MICROSECOND)[0] == BridgeDuty(brake=4096)


def test_the_pointer_goes_on_with_ai_and_wraps_where_the_registers_end() -> None:
    it = Master()
    it.write("00 20")
    it.write("45 03 31 04")
    assert [it.chip.register(n) for n in (0x45, 0, 1)] == [0x03, 0x31, 0x04]
    it.write("FE 07 21")
    assert [it.chip.register(n) for n in (0xFE, 0)] == [0x07, 0x21]
    it.write("06")
    assert it.do(read(ADDRESS, 4)).read == bytes.fromhex("00 00 00 10")
    it.write("00 01")
    it.write("06 01 02 03")
    assert [it.chip.register(n) for n in (6, 7)] == [3, 0]


def test_all_led_writes_through_and_reads_nothing() -> None:
    it = Master()
    it.write("00 20")
    it.write("FA 11 F2 33 E4")
    for n in range(16):
        assert [it.chip.register(6 + 4 * n + k) for k in range(4)] == [0x11, 0x12, 0x33, 0x04]
    it.write("FA")
    assert it.do(read(ADDRESS, 4)).read == bytes(4)


@pytest.mark.parametrize(
    ("mode1", "address", "answers"),
    [
        (0x01, 0x70, True),
        (0x00, 0x70, False),
        (0x08, 0x71, True),
        (0x04, 0x72, True),
        (0x02, 0x74, True),
        (0x0D, 0x74, False),
        (0x00, 0x60, True),
        (0x00, 0x61, False),
    ],
)
def test_group_addresses_by_their_bits_and_to_write_alone(mode1: int, address: int, *, answers: bool) -> None:
    it = Master()
    it.write(f"00 {mode1:02X}")
    assert it.write("06", address).acknowledged is answers
    assert it.do(read(address, 1)).acknowledged is (answers and address == ADDRESS)


def test_the_all_call_address_can_be_another() -> None:
    it = Master()
    it.write("05 C3")
    assert it.write("06", 0x61).acknowledged
    assert not it.write("06", 0x70).acknowledged


@pytest.mark.parametrize(("data", "resets"), [("06", True), ("07", False), ("06 06", False)])
def test_the_general_call_resets_with_one_byte_alone(data: str, *, resets: bool) -> None:
    it = Master().begin()
    it.write("2E 00 10 00 00")
    assert it.write(data, GENERAL_CALL).acknowledged is resets
    assert (it.chip.register(0) == 0x11) is resets
    assert (it.motors()[0] == COAST) is resets


def test_open_drain_cannot_lift_an_input_and_invert_turns_levels() -> None:
    it = Master().begin()
    it.write("2E 00 10 00 00")
    it.write("01 00")
    assert it.motors()[0] == COAST
    it.write("01 14")
    assert it.motors()[0] == BridgeDuty(ccw=4096)  # PWM high, IN1 low, IN2 high


# The half bridges


@pytest.mark.parametrize(
    ("in1", "in2", "pwm", "standby", "expected"),
    [
        (1, 1, 1, 0, Bridge.BRAKE),
        (1, 1, 0, 0, Bridge.BRAKE),
        (0, 1, 1, 0, Bridge.CCW),
        (0, 1, 0, 0, Bridge.BRAKE),
        (1, 0, 1, 0, Bridge.CW),
        (1, 0, 0, 0, Bridge.BRAKE),
        (0, 0, 1, 0, Bridge.OPEN),
        (0, 0, 0, 0, Bridge.OPEN),
        (1, 0, 1, 1, Bridge.OPEN),
        (1, 1, 1, 1, Bridge.OPEN),
    ],
)
def test_the_function_table(in1: int, in2: int, pwm: int, standby: int, expected: Bridge) -> None:
    assert bridge(in1=bool(in1), in2=bool(in2), pwm=bool(pwm), standby=bool(standby)) is expected


WAVES = st.builds(Wave, st.integers(0, 4095), st.integers(0, 4096))


@given(WAVES, WAVES, WAVES)
def test_the_shares_are_those_of_counting_one_by_one(pwm: Wave, in1: Wave, in2: Wave) -> None:
    counts = dict.fromkeys(Bridge, 0)
    for count in range(4096):
        levels = [(count - it.rises) % 4096 < it.high for it in (pwm, in1, in2)]
        counts[bridge(pwm=levels[0], in1=levels[1], in2=levels[2])] += 1
    made = share(pwm, in1, in2)
    assert [made.cw, made.ccw, made.brake, made.open] == [counts[it] for it in Bridge]


def test_the_mean_voltage_is_the_duty_less_what_the_transistors_take() -> None:
    half = BridgeDuty(cw=2048, brake=2048)
    assert half.volts(12.0, 0.0) == pytest.approx(6.0)
    assert half.volts(12.0, 1.0) == pytest.approx(5.5)
    assert BridgeDuty(brake=4096).volts(12.0, 2.0) == pytest.approx(-1.0)
    assert BridgeDuty(ccw=4096).volts(12.0, 0.0) == pytest.approx(-12.0)
    assert COAST.volts(12.0, 0.0) == 0.0


def test_a_current_at_its_limit_is_not_driven_further() -> None:
    half = BridgeDuty(cw=2048, brake=2048)
    assert limited(half, 3.19) == half
    assert limited(half, 3.2) == BridgeDuty(brake=4096)
    assert limited(half, -3.2) == half
    assert limited(BridgeDuty(ccw=1024, brake=3072), -6.3) == BridgeDuty(brake=4096)


@every(
    ("supply", "was", "off", "ohm"),
    [(12.0, False, False, 0.5), (5.0, False, False, 0.5),
     (4.0, False, False, 0.625), (2.5, False, False, 1.0),
     (2.49, False, True, 1.0), (2.79, True, True, 5.0 / 2.79 / 2), (2.8, True, False, 5.0 / 2.8 / 2),
     (0.0, True, True, 1.0)],
)  # fmt: skip
def test_a_supply_that_sags_weakens_the_half_bridges_and_then_locks_them(
    supply: float, ohm: float, *, was: bool, off: bool
) -> None:
    assert locked(supply, was=was) is off
    assert on_resistance(supply) == pytest.approx(ohm)


def test_a_chip_that_is_too_hot_is_off_until_it_has_cooled() -> None:
    chip = Thermal()
    drives = BridgeDuty(cw=4096)
    chip.advance((1.2, 0.0), 100 * SECOND)
    assert chip.passes(drives) == drives
    chip.advance((6.3, 0.0), 101 * SECOND)
    assert chip.passes(drives) == COAST
    states = []
    for second in range(102, 112):
        chip.advance((0.0, 0.0), second * SECOND)
        states.append((chip.celsius, chip.shut_down))
    assert all(off is (celsius >= 155.0) for celsius, off in states)
    assert {off for _, off in states} == {True, False}
    assert all(after < before for (before, _), (after, _) in pairwise(states))


@given(
    st.lists(
        st.tuples(st.sampled_from([0x00, 0x60, 0x70, 0x71, 0x33]), st.binary(max_size=32), st.integers(0, 8))
    )
)
def test_whatever_is_on_the_bus_time_passes_and_the_four_shares_add_up(
    transfers: list[tuple[int, bytes, int]],
) -> None:
    it = Master()
    for address, data, to_read in transfers:
        before = it.now
        it.do(Transfer((TransferSegment(address, data), TransferSegment(address, to_read=to_read))))
        assert it.now > before
        for output in it.motors():
            assert output.cw + output.ccw + output.brake + output.open == 4096
