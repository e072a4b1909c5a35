"""Set-point frames: bytes as recorded from drivers of maxon drives, the handshake, and the safe word."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.canopen_drive.driver.feedback import DriveFeedback
from firmware_bridge.canopen_drive.driver.scale import Scale, highest_speed
from firmware_bridge.canopen_drive.driver.set_point import PositionSetPoint, VelocitySetPoint
from firmware_bridge.drivers.driver import Position, SetPoint, Speed, Stop
from firmware_bridge.families.epos2.driver.product import product
from firmware_bridge.robot import Axis
from hil_tests.rows import every
from hil_tests.unit.drivers.robots import LINK, RARS, with_axis

LEFT = RARS.axis("left_wheel")
SCALE = Scale.of(RARS.axis("steering"))
STEER = with_axis(RARS.axis("steering"), travel=(SCALE.position(-1000), SCALE.position(1000)))
NOT_ENABLED = [None, *(state for state in PowerState if state is not PowerState.OPERATION_ENABLED)]


def to(quadcounts: float) -> Position:
    """The set-point for a position of the steering that is given in quadcounts."""
    return Position(quadcounts / SCALE.counts_per_unit)


DEMANDS: list[SetPoint] = [Speed(1.0), to(500), *Stop]


def feedback(
    axis: Axis, state: PowerState | None = PowerState.OPERATION_ENABLED, position: int = 0
) -> DriveFeedback:
    made = DriveFeedback(axis, product(axis))
    made.state, made.position_counts = state, position
    return made


def wheel(state: PowerState | None = PowerState.OPERATION_ENABLED) -> VelocitySetPoint:
    return VelocitySetPoint(LEFT, feedback(LEFT, state))


def steering(state: PowerState | None = PowerState.OPERATION_ENABLED, position: int = 0) -> PositionSetPoint:
    return PositionSetPoint(STEER, feedback(STEER, state, position))


@pytest.mark.parametrize(
    ("set_point", "payload"),
    [
        # Recorded (kay01-kwon, EPOS2 candump): 0F 00 and 4112 rpm; 16.562 rad/s behind 26:1 are 4112 rpm.
        (Speed(16.5622), "0f 00 84 0f 00 00"),  # ... and the axis's top speed is 16 rad/s
        (Speed(6.0), "0f 00 d2 05 00 00"),  # 1490 rpm
        (Speed(-6.0), "0f 00 2e fa ff ff"),
        (Speed(0.0), "0f 00 00 00 00 00"),
        (Stop.STANDSTILL, "0f 00 00 00 00 00"),
        (Stop.QUICK_STOP, "0b 00 00 00 00 00"),
        (Stop.POWER_OFF, "00 00 00 00 00 00"),
        (Position(7), "0f 00 00 00 00 00"),
    ],
    ids=str,
)
def test_a_wheels_set_point_becomes_these_bytes(set_point: SetPoint, payload: str) -> None:
    packet = wheel().frame_for(set_point)
    assert (packet.link, packet.address) == (LINK, 0x501)
    assert packet.payload.hex(" ") == payload


def test_a_reversed_axis_turns_the_other_way() -> None:
    reversed_axis = with_axis(LEFT, direction=-1)
    packet = VelocitySetPoint(reversed_axis, feedback(reversed_axis)).frame_for(Speed(6.0))
    assert packet.payload.hex(" ") == "0f 00 2e fa ff ff"


@every("state", NOT_ENABLED, ids=str)
@every("set_point", [Speed(3.0), to(500), Stop.STANDSTILL, Stop.QUICK_STOP], ids=str)
def test_a_drive_that_is_not_enabled_receives_quick_stop_only(
    state: PowerState | None, set_point: SetPoint
) -> None:
    assert wheel(state).frame_for(set_point).payload.hex(" ") == "0b 00 00 00 00 00"
    assert steering(state).frame_for(set_point).payload.hex(" ") == "0b 00 00 00 00 00"


def test_a_new_position_rises_is_released_and_is_not_sent_again() -> None:
    # maxon's library: move absolute, at once = 0x003F; bit 4 goes low before the next one.
    axis = steering()
    assert axis.frame_for(to(500)).payload.hex(" ") == "3f 00 f4 01 00 00"
    released = axis.release()
    assert released is not None
    assert released.payload.hex(" ") == "0f 00 f4 01 00 00"
    assert axis.release() is None
    assert axis.frame_for(to(500)).payload.hex(" ") == "0f 00 f4 01 00 00"


@pytest.mark.parametrize(("change", "word"), [(-2, "3f"), (-1, "0f"), (0, "0f"), (1, "0f"), (2, "3f")])
def test_a_position_that_hardly_changed_is_not_new(change: int, word: str) -> None:
    axis = steering()
    axis.frame_for(to(500))
    axis.release()
    assert axis.frame_for(to(500 + change)).payload.hex(" ").startswith(word)


def test_before_the_release_a_newer_position_waits() -> None:
    axis = steering()
    axis.frame_for(to(500))
    assert axis.frame_for(to(600)).payload.hex(" ") == "3f 00 f4 01 00 00"
    axis.release()
    assert axis.frame_for(to(600)).payload.hex(" ") == "3f 00 58 02 00 00"


def test_rest_is_halt_with_the_last_target_and_ends_the_handshake() -> None:
    axis = steering()
    axis.frame_for(to(500))
    assert axis.frame_for(Stop.STANDSTILL).payload.hex(" ") == "0f 01 f4 01 00 00"
    assert axis.release() is None


def test_after_a_rest_the_same_position_is_new() -> None:
    axis = steering()
    axis.frame_for(to(500))
    axis.frame_for(Stop.STANDSTILL)
    assert axis.frame_for(to(500)).payload.hex(" ") == "3f 00 f4 01 00 00"


def test_words_on_the_way_to_power_carry_the_actual_position() -> None:
    axis = steering(PowerState.SWITCHED_ON, position=-321)
    assert axis.word(0x000F).payload.hex(" ") == "0f 00 bf fe ff ff"


@pytest.mark.parametrize("state", NOT_ENABLED, ids=str)
def test_the_release_never_puts_power_on_again(state: PowerState | None) -> None:
    known = feedback(STEER)
    axis = PositionSetPoint(STEER, known)
    axis.frame_for(to(500))
    known.state = state
    released = axis.release()
    assert released is not None
    assert released.payload.hex(" ")[:5] == "0b 00"
    assert axis.release() is None


@given(
    st.lists(st.one_of(st.sampled_from(DEMANDS), st.builds(Position, st.floats()), st.none())),
    st.sampled_from([None, *PowerState]),
)
def test_a_target_never_leaves_the_travel(script: list[SetPoint | None], state: PowerState | None) -> None:
    axis = steering(state, position=2**31 - 1)
    for set_point in script:
        packet = axis.release() if set_point is None else axis.frame_for(set_point)
        if packet is not None:
            assert -1000 <= int.from_bytes(packet.payload[2:], "little", signed=True) <= 1000


@given(st.floats())
def test_a_speed_never_exceeds_the_top_speed(rad_s: float) -> None:
    payload = wheel().frame_for(Speed(rad_s)).payload
    assert abs(int.from_bytes(payload[2:], "little", signed=True)) <= highest_speed(LEFT) == 3972


@pytest.mark.parametrize("value", [float("nan"), float("inf"), float("-inf")])
def test_what_is_no_number_counts_as_rest(value: float) -> None:
    assert wheel().frame_for(Speed(value)).payload.hex(" ") == "0f 00 00 00 00 00"
    axis = steering()
    axis.frame_for(to(500))
    assert axis.frame_for(Position(value)).payload.hex(" ") == "0f 01 f4 01 00 00"


@pytest.mark.parametrize(("travel", "ends"), [((-0.2, 0.5), (-400, 1000)), ((0.0, 0.1), (0, 200))])
@pytest.mark.parametrize("direction", [1, -1])
def test_a_slide_in_meters_stays_in_its_travel(
    travel: tuple[float, float], ends: tuple[int, int], direction: int
) -> None:
    """A screw of 2 pi rad for each meter: 2000 quadcounts of 500 lines are one meter."""
    slide = with_axis(STEER, unit="m", ratio=2.0 * math.pi, travel=travel, direction=direction)
    axis = PositionSetPoint(slide, feedback(slide))
    for far in (-10.0, 10.0):
        target = int.from_bytes(axis.frame_for(Position(far)).payload[2:], "little", signed=True)
        assert target == direction * ends[far > 0.0]
        axis.release()


def test_a_drive_far_beyond_its_counters_wrap_is_stopped_where_the_counter_is() -> None:
    endless = with_axis(STEER, travel=(SCALE.position(-(2**31)) + 1.0, SCALE.position(2**31) - 1.0))
    axis = PositionSetPoint(endless, feedback(endless, position=2**32 + 77))
    assert axis.word(0x0006).payload.hex(" ") == "06 00 4d 00 00 00"
