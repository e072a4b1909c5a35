"""The bridge's side of a motor shield without a board: words, regulator, counters, plan, steps of a stop."""

from collections import deque
from itertools import pairwise
from typing import Any, Final

import pytest

from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.motors import four_motors
from firmware_bridge.drivers.driver import Reports, Speed, Stop
from firmware_bridge.drivers.life_cycle import AT_REST, Task, Transition
from firmware_bridge.drivers.link_drivers import PlanError
from firmware_bridge.families.motor_shield.driver.dialects import DIALECTS, Dialect
from firmware_bridge.families.motor_shield.driver.expressed import expressed
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol, shield_link_drivers
from firmware_bridge.families.motor_shield.driver.motor import ShieldMotor
from firmware_bridge.families.motor_shield.driver.plan import MOST, fitting_plan, shield_plan
from firmware_bridge.families.motor_shield.driver.regulator import Pwm, Ticks
from firmware_bridge.families.motor_shield.driver.stops import stop_stages
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink, ShieldProtocol
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

ROME: Final = find("rome")
CYCLE: Final[Nanoseconds] = 50 * MILLISECOND
FORWARD: Final = {1: 1, 2: 1, 3: 1}


def over(protocol: str, encoders: int | None = None) -> AnyRobot:
    return over_protocol(ROME, protocol, encoders)


def dialect(protocol: str, encoders: int | None = None) -> Dialect:
    robot = over(protocol, encoders)
    link = ShieldLink.of_link(robot, "board")
    return DIALECTS[link.protocol](link, [ShieldAxis.of(axis) for axis in robot.axes])


def stated(protocol: str, words: str, *given: Any) -> list[str]:
    """Return a dialect's bytes, in hexadecimal; text where it is a line."""
    made = [say.data for say in getattr(dialect(protocol), words)(*given)]
    return [data.decode().rstrip("\r") if data.endswith(b"\r") else data.hex(" ") for data in made]


@pytest.mark.parametrize(
    ("protocol", "words", "given", "expected"),
    [
        # ros_arduino_bridge: the exchange of its host, with a third motor.
        ("ros-arduino-bridge", "drive", ({1: 10, 2: -5, 3: 0}, {}), ["m 10 -5 0"]),
        ("ros-arduino-bridge", "release", ((2,),), ["m 0 0 0"]),
        ("ros-arduino-bridge", "encoders", (), ["e"]),
        # ArduinoIO: motor 1 at speed 200, forward; its release; encoders 0 and 1.
        ("arduinoio", "drive", ({1: 200}, {1: 0}), ["42 31 66", "41 31 c8"]),
        ("arduinoio", "drive", ({1: 200}, {1: 1}), ["41 31 c8"]),
        ("arduinoio", "drive", ({1: -200}, {1: 1}), ["42 31 62", "41 31 c8"]),
        ("arduinoio", "drive", ({1: 0}, {1: -1}), ["41 31 00"]),
        ("arduinoio", "release", ((1,),), ["41 31 00", "42 31 72"]),
        ("arduinoio", "encoders", (), ["47 30", "47 31"]),
        # Firmata: M1 at speed 128, as the shield's library writes the channel.
        ("firmata", "drive", ({1: 128}, {1: 1}), ["f0 76 60 00 26 00 00 00 00 00 00 00 08 00 f7"]),
    ],
)
def test_what_is_stated_is_what_the_firmware_reads(
    protocol: str, words: str, given: tuple[Any, ...], expected: list[str]
) -> None:
    assert stated(protocol, words, *given) == expected


def test_mwprotocol_states_the_worked_frames() -> None:
    """Shield, motors and encoders as in the worked frames, but for libraries in our order."""
    frames = stated("mw", "drive", {3: -255}, FORWARD)
    assert [frame.split()[3:-1] for frame in frames] == [["81", "02", "05", "00", "02", "ff", "02"]]
    stopped = stated("mw", "release", (1,))
    assert [frame.split()[4:-1] for frame in stopped] == [["02", "04", "00", "00"]]


def motor(protocol: str = "arduinoio", place: int = 0, encoders: int | None = None) -> ShieldMotor:
    made = shield_link_drivers(over(protocol, encoders), "board").drivers[place]
    assert isinstance(made, ShieldMotor)
    return made


@pytest.mark.parametrize(
    ("protocol", "counts", "moved"),
    [
        ("arduinoio", (32_700, -32_736), 100),
        ("arduinoio", (-32_700, 32_736), -100),
        ("mw", (2**31 - 50, -(2**31) + 50), 100),
        ("ros-arduino-bridge", (1_000, 900), -100),
    ],
)
def test_counters_are_unwrapped(protocol: str, counts: tuple[int, int], moved: int) -> None:
    one, bits = motor(protocol), dialect(protocol).bits
    for place, count in enumerate(counts):
        at = place * CYCLE + SECOND
        one.counted(count, bits, at, at)
        one.sampled(at, at)
    turned = moved / (48 * 64.0) * 2.0 * 3.141592653589793
    assert one.feedback.position == pytest.approx(turned)
    assert one.feedback.velocity == pytest.approx(turned / 0.05)


def test_a_motor_that_is_not_counted_is_believed_and_states_so() -> None:
    """The third one over ArduinoIO: it goes as commanded, and reports neither place nor speed."""
    one = motor("arduinoio", 2)
    assert one.reports == frozenset()
    assert motor("arduinoio", 2, 3).reports == {Reports.POSITION, Reports.VELOCITY, Reports.STOP}
    one.enabled = True
    one.command(Speed(2.0))
    for cycle in range(3):
        one.sampled(cycle * CYCLE, cycle * CYCLE)
    assert (one.feedback.position, one.feedback.velocity) == pytest.approx((0.2, 2.0))


def run(regulator: Pwm | Ticks, wanted: float, velocity: float | None, cycles: int) -> list[int]:
    return [regulator.next(wanted, velocity, CYCLE) for _ in range(cycles)]


def test_the_pwm_changes_by_its_slope_and_passes_0_on_its_way_back() -> None:
    axis = ROME.axes[0]
    regulator, step = Pwm(axis, CYCLE), 30
    up = run(regulator, 8.0, 0.0, 20)
    assert up[:5] == [30, 60, 90, 120, 150]
    assert max(up) <= 255
    back = run(regulator, -8.0, 8.0, 40)
    assert 0 in back
    assert all(abs(new - old) <= step for old, new in zip([up[-1], *back], back, strict=False))
    assert all(old * new >= 0 for old, new in pairwise(back))


def test_at_rest_it_forgets_how_far_it_was_behind() -> None:
    regulator = Pwm(ROME.axes[0], CYCLE)
    run(regulator, 1.0, 0.0, 40)
    assert run(regulator, 0.0, 0.0, 20)[-1] == 0
    assert abs(run(regulator, 0.5, 0.5, 1)[0]) <= 30


def test_without_an_encoder_it_feeds_forward_alone() -> None:
    reported = run(Pwm(ROME.axes[0], CYCLE), 7.0, None, 40)
    assert reported[-1] == round(255 * 7.0 / (8_500 * 6.283185307179586 / 60 / 64) + 4)


def test_a_loop_on_the_board_is_read_whole_counts_a_frame_and_no_more_than_the_guard_lets_through() -> None:
    axis = ROME.axes[0]
    ticks = Ticks(axis, CYCLE)
    assert ticks.next(5.0, None, CYCLE) == round(5.0 * 3072 / 6.283185307179586 * 0.033)
    assert ticks.next(-5.0, None, CYCLE) == 0, "a reversal passes 0"
    assert ticks.next(-5.0, None, CYCLE) == -81
    assert ticks.next(-99.0, None, CYCLE) == -int(axis.top_speed * 3072 / 6.283185307179586 * 0.033)


@pytest.mark.parametrize("protocol", ShieldProtocol)
def test_a_reversal_fits_in_the_cycle_that_each_protocol_has(protocol: ShieldProtocol) -> None:
    robot = over(protocol.value)
    plan = fitting_plan(robot, "board")
    assert plan.cycle == (100 if protocol is ShieldProtocol.MW else 50) * MILLISECOND
    assert plan.share <= MOST


def test_what_does_not_fit_is_refused_with_its_time_and_the_remedy() -> None:
    link = ShieldLink.of_link(over("mw"), "board").model_copy(update={"every": 1, "port_latency_us": 3_000})
    tight = over("mw").with_links({"board": link})
    assert shield_plan(tight, "board").share > MOST
    with pytest.raises(
        PlanError,
        match=r"a reversal over mw takes 4\d\.\d ms, .* more than 80% of its cycle of 50 ms; use every = 2",
    ):
        fitting_plan(tight, "board")


@pytest.mark.parametrize(
    ("robot", "protocol", "encoders", "problem"),
    [
        ("rome", "firmatta", None, "no 'firmatta'; perhaps 'firmata'?"),
        ("rars", "mw", None, "no motor shield is on any link"),
        ("rome", "ros-arduino-bridge", 2, "counts as many motors as it drives: 3"),
    ],
)
def test_another_firmware_that_cannot_be_is_refused(
    robot: str, protocol: str, encoders: int | None, problem: str
) -> None:
    with pytest.raises(RobotFileError, match=problem):
        over_protocol(find(robot), protocol, encoders)


def test_a_stop_ends_with_the_boards_reset_and_reports_of_its_own_stop_where_it_has_one() -> None:
    names, notes = {}, {}
    for protocol in ("ros-arduino-bridge", "arduinoio"):
        robot = over(protocol)
        stages = stop_stages(robot, robot.axes[0])
        names[protocol] = [stage.name for stage in stages]
        notes[protocol] = stages[-1].note
        assert stages[-1].transition is Transition.RESET
        assert stages[2].within == 3 * ShieldLink.of_link(robot, "board").answers_within_ms * MILLISECOND
        assert stages[0].set_point is Stop.STANDSTILL
        assert all(stage.set_point is Stop.POWER_OFF for stage in stages if stage.ends_power)
    assert names["ros-arduino-bridge"] == names["arduinoio"] == ["speed 0", "brake", "release", "reset"]
    assert "it stops them 2000 ms after the last one" in notes["ros-arduino-bridge"]
    assert "it stops" not in notes["arduinoio"]


def test_what_answers_a_task_that_a_stop_has_ended_is_nobodys() -> None:
    """The bridge lives on; motors that it has not released count as driven, by any earlier driver."""
    link_drivers = shield_link_drivers(over("ros-arduino-bridge"), "board")
    board, one = link_drivers.link, link_drivers.drivers[0]
    requested = one.begin(Transition.CONFIGURE, SECOND, Task.IDENTIFY)
    requested += board.wake(SECOND + 100 * MILLISECOND)
    assert [packet.payload for packet in requested] == [b"b\r"]
    one.command(Stop.POWER_OFF)
    assert one.state in AT_REST
    released = board.receive(Packet("board", 0, b"57600\r\n"), SECOND + 110 * MILLISECOND)
    assert [packet.payload for packet in released] == [b"m 0 0 0\r"]
    assert not one.unpowered


@pytest.mark.parametrize(
    ("protocol", "wires", "remark"),
    [
        ("mw", True, "the board has begun again, and released its motors, within 1."),
        ("firmata", True, "the board has begun again, and released its motors, within 3."),
        ("arduinoio", True, "nothing shows that the line's reset works"),
        ("mw", False, "nothing shows that the line's reset works"),
        ("ros-arduino-bridge", True, ""),
    ],
)
def test_a_start_shows_whether_the_reset_of_a_board_works_that_does_not_stop_by_itself(
    protocol: str, remark: str, *, wires: bool
) -> None:
    """Start by a firmware's own greeting; ArduinoIO sends none, and a cut wire lets nothing begin."""
    link = shield_link_drivers(over(protocol), "board").link
    board = Board(
        FIRMWARES[protocol], four_motors(), encoders=ShieldLink.of_link(over(protocol), "board").counted
    )
    now, ended = 5 * SECOND, False
    for at in range(0, now, SECOND // 10):
        board.wake(at)
    sent = deque(link.begin(Transition.CONFIGURE, now))  # type: ignore[attr-defined]
    while now < 10 * SECOND and not ended:
        while sent:
            packet = sent.popleft()
            if wires or packet.payload:
                for stated in board.receive(Packet(SERIAL, packet.address, packet.payload), now).sent:
                    sent.extend(link.receive(Packet("board", stated.address, stated.payload), now))
        now += MILLISECOND
        for stated in board.wake(now).sent:
            sent.extend(link.receive(Packet("board", stated.address, stated.payload), now))
        if link.wake_at <= now:
            sent.extend(link.wake(now))
        ended = link.configured  # type: ignore[attr-defined]
    assert ended
    assert (remark in link.remark) if remark else not link.remark


@pytest.mark.parametrize("transition", [Transition.POWER_OFF, Transition.DEACTIVATE])
@pytest.mark.parametrize("protocol", ShieldProtocol)
def test_a_silent_board_is_reported_every_word_that_lets_go_before_one_again(
    protocol: ShieldProtocol, transition: Transition
) -> None:
    link = shield_link_drivers(over(protocol), "board").link
    reported = [packet.payload for packet in link.begin(transition, SECOND)]  # type: ignore[attr-defined]
    for at in range(SECOND, 2 * SECOND, MILLISECOND):
        reported += [packet.payload for packet in (link.wake(at) if link.wake_at <= at else ())]
    words = len(set(reported))
    assert words > 1
    assert len(set(reported[:words])) == words
    assert len(reported) > words + 3, "and again, while it may be received"


def test_motors_that_are_released_stay_so_while_speed_0_is_stated_again() -> None:
    """Speed 0 for all of them drives none, whether the board answers it or not."""
    link_drivers = shield_link_drivers(over("ros-arduino-bridge"), "board")
    motors = [one for one in link_drivers.drivers if isinstance(one, ShieldMotor)]
    for one in motors:
        one.enabled, one.set_point = True, Speed(0.0)
    words, releases = expressed(dialect("ros-arduino-bridge"), motors, SECOND, configured=True)
    assert [word.data for word in words] == [b"m 0 0 0\r"]
    assert releases == motors
    for one in motors:
        one.direction, one.released = 0, True
    expressed(dialect("ros-arduino-bridge"), motors, SECOND + CYCLE, configured=True)
    assert all(one.unpowered for one in motors)
    motors[0].set_point = Speed(1.0)
    expressed(dialect("ros-arduino-bridge"), motors, SECOND + 2 * CYCLE, configured=True)
    assert not any(one.unpowered for one in motors)
