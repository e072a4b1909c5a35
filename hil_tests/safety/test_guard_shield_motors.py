"""Motors at a shield behind the guard: speeds, bounds and slopes in numbers, and packets without a command.

A count of ros_arduino_bridge is one of 48 x 64 of a wheel's turn in 33 ms; elsewhere a PWM of 255 counts as
8500 rpm behind the gear of 64.
"""

from typing import Any, Final

import pytest

from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.guard.rules import GuardedMotor, ShieldRules
from firmware_bridge.families.motor_shield.wire import mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.node import DTR_DOWN, DTR_UP, LINE_BACK, LINE_LOST
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.safety.test_guard_shield import CYCLE, Bench, pwm, speeds, way

TICK: Final = 0.06197902
"""rad/s: 2 pi / 3072 in 33 ms."""
FREE: Final = 13.908093
"""rad/s: 8500 rpm / 64."""
STEEP: Final = 100_000.0
"""A slope that never binds."""


def rules_of(protocol: str, direction: int = 1, **settings: Any) -> ShieldRules:
    """Return the rules of ROME's board, with other settings of its motors."""
    robot = over_protocol(find("rome"), protocol)
    axes = tuple(
        axis.model_copy(
            update={"direction": direction, "settings": axis.settings.model_copy(update=settings)}
        )
        for axis in robot.axes
    )
    return ShieldRules(robot.model_copy(update={"axes": axes}), "board")


def command(data: bytes, address: int = 0) -> Packet:
    return Packet("board", address, data)


def sends(rules: ShieldRules, *words: bytes, now: Nanoseconds = 0) -> None:
    """Send commands, none of which is refused."""
    for data in words:
        assert rules.refuses(command(data), now) is None
        rules.sends(command(data), now, requested=False)


def motor(rules: ShieldRules, number: int = 1) -> GuardedMotor:
    (found,) = (one for one in rules.axes if isinstance(one, GuardedMotor) and one.number == number)
    return found


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize(
    ("protocol", "before", "word", "requested"),
    [
        ("ros-arduino-bridge", (), speeds(190, 0, -100), [190 * TICK, 0.0, -100 * TICK]),
        ("arduinoio", (way(1, "f"),), pwm(1, 255), [FREE]),
        ("arduinoio", (way(1, "b"),), pwm(1, 255), [-FREE]),
        ("arduinoio", (way(2, "f"),), pwm(2, 51), [FREE / 5.0]),
        ("arduinoio", (), pwm(1, 255), [0.0]),
    ],
)
def test_a_command_requests_the_speed_that_it_can_come_to(
    protocol: str, before: tuple[bytes, ...], word: bytes, requested: list[float], direction: int
) -> None:
    rules = rules_of(protocol, direction, slope_pwm_s=STEEP)
    sends(rules, *before)
    found = rules.requested_by(command(word))
    assert [one.speed for one in found.values()] == pytest.approx([direction * it for it in requested])
    assert [one.moves for one in found.values()] == [it != 0.0 for it in requested]
    sends(rules, word)
    assert [one.speed for one in found] == pytest.approx([direction * it for it in requested])


@pytest.mark.parametrize(("most", "size", "passes"), [(255, 255, True), (100, 100, True), (100, 101, False)])
def test_a_pwm_is_bounded_by_the_robot_file(most: int, size: int, *, passes: bool) -> None:
    rules = rules_of("arduinoio", max_pwm=most, slope_pwm_s=STEEP)
    sends(rules, way(1, "f"))
    refusal = rules.refuses(command(pwm(1, size)), 0)
    assert refusal == (None if passes else f"motor M1 (wheel at 0 degrees): {size} PWM is beyond {most}")


@pytest.mark.parametrize(
    ("protocol", "ahead", "back", "unit"),
    [
        ("ros-arduino-bridge", (speeds(20, 0, 0),), speeds(-20, 0, 0), "ticks"),
        ("arduinoio", (way(1, "f"), pwm(1, 20)), way(1, "b"), "PWM"),
    ],
)
def test_a_reversal_is_refused_in_the_unit_of_its_firmware(
    protocol: str, ahead: tuple[bytes, ...], back: bytes, unit: str
) -> None:
    rules = rules_of(protocol)
    sends(rules, *ahead)
    assert rules.refuses(command(back), SECOND) == (
        f"motor M1 (wheel at 0 degrees): reversed to -20 {unit} without standing at 0"
    )


@pytest.mark.parametrize(
    ("later_ms", "most"),
    [(0, 15), (1, 16), (50, 45), (51, 46), (52, 47), (53, 47), (100, 75), (1000, 75)],
)
def test_a_pwm_rises_by_600_a_second_rounded_up_and_half_a_cycle_of_room(later_ms: int, most: int) -> None:
    """The cycle has 50 ms; two of them count at most."""
    rules = rules_of("arduinoio")
    sends(rules, way(1, "f"), pwm(1, 30))
    later = later_ms * MILLISECOND
    assert rules.refuses(command(pwm(1, 30 + most)), later) is None
    assert rules.refuses(command(pwm(1, 30 + most + 1)), later) == (
        f"motor M1 (wheel at 0 degrees): from 30 to {30 + most + 1} PWM at once, {most} is allowed"
    )


def test_a_motor_without_any_set_point_is_overdue_while_another_one_turns() -> None:
    bench = Bench("arduinoio")
    bench.say(way(1, "f"), pwm(1, 20))
    assert bench.say(pwm(1, 20), later=CYCLE) == [pwm(1, 20)]
    assert bench.say(pwm(1, 20), later=CYCLE) == [pwm(1, 20)]
    assert bench.say(pwm(1, 20), later=CYCLE) == [pwm(1, 20), pwm(1, 0)]
    assert bench.reason == "no set-point for 150 ms: wheel at 120 degrees, wheel at 240 degrees"


@pytest.mark.parametrize(
    ("data", "address", "refusal"),
    [
        (b"", DTR_UP, None),
        (b"", DTR_DOWN, None),
        (speeds(1, 0, 0), DTR_UP, "the command '6d 20 31 20 30 20 30 0d' is not listed"),
        (speeds(1, 0, 0), DTR_DOWN, "the command '6d 20 31 20 30 20 30 0d' is not listed"),
        (speeds(1, 0, 0), 7, "the command '6d 20 31 20 30 20 30 0d' is not listed"),
        (b"", 7, "the command '' is not listed"),
    ],
)
def test_a_command_has_one_address(data: bytes, address: int, refusal: str | None) -> None:
    rules = rules_of("ros-arduino-bridge")
    packet = command(data, address)
    assert rules.refuses(packet, 0) == refusal
    assert (rules.axes_of(packet), rules.requested_by(packet)) == ((), {})
    assert rules.sends(packet, 0, requested=False) == ()
    assert not motor(rules).moving


def answer_with(*libraries: str) -> bytes:
    """Answer of a board that lists its libraries."""
    info = messages.ServerInfo(17, 1, b"Mega2560", 0, tuple(name.encode() for name in libraries))
    return mw.encode_answer(1, mw.row_of(messages.GetServerInfo()).answer.encode(info))


def motor_speed(*libraries: str) -> bytes:
    """Command of a motor's speed to a board with these libraries."""
    return mw.encode_request(messages.SetMotorSpeed(0, 0, 20, 1), 1, libraries)


SETS: Final = ((mw.SHIELD, mw.ENCODER), ("I2C", mw.SHIELD), ("I2C", "Servo", mw.ENCODER, mw.SHIELD))


@pytest.mark.parametrize("rounds", [1, 2])
def test_of_several_answers_the_newest_names_a_boards_libraries(rounds: int) -> None:
    rules = rules_of("mw")
    for libraries in SETS * rounds:
        assert rules.receives(command(answer_with(*libraries)), 0)
        listed = [one for one in SETS if rules.refuses(command(motor_speed(*one)), 0) is None]
        assert listed == [libraries]


@pytest.mark.parametrize("address", [LINE_LOST, LINE_BACK])
def test_a_packet_about_the_line_is_no_answer_of_the_board(address: int) -> None:
    rules = rules_of("mw")
    assert rules.receives(command(answer_with(*SETS[0]), address), 0)
    assert "is not listed" in str(rules.refuses(command(motor_speed(*SETS[0])), 0))
    assert rules.refuses(command(motor_speed(*mw.LIBRARIES)), 0) is None
