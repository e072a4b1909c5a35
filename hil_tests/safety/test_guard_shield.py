"""Commands to a board with a motor shield that the guard lets through, at both edges of each bound."""

from typing import Any, Final

import pytest

from emulators.rig import BRIDGE
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.families.motor_shield.wire import arduinoio, firmata, motor_shield, mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as ros
from firmware_bridge.families.motor_shield.wire.motor_shield import Pin
from firmware_bridge.node import DTR_DOWN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.safety.guard import Guarded, guarded
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.safety.driving import SHIELDS, driving, speed

CYCLE: Final[Nanoseconds] = 50 * MILLISECOND


class Talker:
    """A bridge that sends the given commands."""

    def __init__(self) -> None:
        self.states: tuple[Packet, ...] = ()
        self.received: list[bytes] = []

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        del now
        self.received.append(packet.payload)
        return Reaction()

    def wake(self, now: Nanoseconds) -> Reaction:
        del now
        stated, self.states = self.states, ()
        return Reaction(stated)


class Bench:
    """A guard around it, over one protocol."""

    def __init__(self, protocol: str) -> None:
        robot = over_protocol(find("rome"), protocol)
        self.talker: Final = Talker()
        self.guard: Final[Guarded] = guarded(self.talker, robot)
        self.cycle: Final = robot.cycle * robot.links["board"].every
        self.now: Nanoseconds = SECOND

    def say(self, *words: bytes, later: Nanoseconds = 0) -> list[bytes]:
        """Send words; return what has left."""
        self.now += later
        self.talker.states = tuple(Packet("board", 0, word) for word in words)
        return [packet.payload for packet in self.guard.wake(self.now).sent if packet.address == 0]

    def reset(self) -> bool:
        """Lower DTR, as before a reset; return whether that has left."""
        self.talker.states = (Packet("board", DTR_DOWN, b""),)
        return any(packet.address == DTR_DOWN for packet in self.guard.wake(self.now).sent)

    @property
    def reason(self) -> str:
        """Reason of the newest refusal."""
        return self.guard.refusals[-1].reason


def speeds(*ticks: int) -> bytes:
    return ros.encode("m", ticks)


def pwm(motor: int, size: int) -> bytes:
    return arduinoio.encode("A", motor, size)


def way(motor: int, letter: str) -> bytes:
    return arduinoio.encode("B", motor, ord(letter))


def channel(motor: int, pin: Pin, level: int) -> bytes:
    return firmata.i2c_write(motor_shield.ADDRESS, motor_shield.encode_channel(motor, pin, level))


STATED: Final = mw.encode_request(messages.GetServerInfo(), 1)[3:-1]
COUNTED: Final = bytes((len(STATED) + 1, 1))
LONGER: Final = tuple(
    bytes((mw.HOST_START,)) + COUNTED + STATED + bytes((mw.checksum(summed + STATED),))
    for summed in (COUNTED, COUNTED[:1])
)
"""A request that counts 256 bytes more than come, and sums them or not."""


@pytest.mark.parametrize(
    ("protocol", "word"),
    [
        ("ros-arduino-bridge", b"o 255 255 255\r"),
        ("ros-arduino-bridge", b"w 8 1\r"),
        ("ros-arduino-bridge", b"m 1 2\r"),
        ("ros-arduino-bridge", b"m 1 2 3"),
        ("ros-arduino-bridge", b"m 1 2 3\rm 9 9 9\r"),
        ("ros-arduino-bridge", b"m 1 2 x\r"),
        ("ros-arduino-bridge", b"u 200:0:0:1\r"),
        ("ros-arduino-bridge", b""),
        ("arduinoio", b"A4\x10"),
        ("arduinoio", b"2n1"),
        ("arduinoio", b"B1x"),
        ("arduinoio", b"A1"),
        ("arduinoio", b"A1\x10A1\xff"),
        ("mw", mw.encode_request(messages.WriteDigital(0, 13, 1), 1)),
        ("mw", mw.encode_request(messages.SetMotorSpeed(0, 3, 9, 1), 1)),
        ("mw", mw.encode_request(messages.SetMotorSpeed(0, 0, 9, 3), 1)),
        ("mw", mw.encode_request(messages.GetServerInfo(), 1)[:-1] + b"\0"),
        ("mw", LONGER[0]),
        ("mw", LONGER[1]),
        ("firmata", bytes((firmata.RESET,))),
        ("firmata", firmata.i2c_write(0x40, bytes((0x26, 0, 0, 0, 8)))),
        ("firmata", firmata.i2c_write(motor_shield.ADDRESS, bytes((0xFA, 0, 0x10, 0, 0)))),
        ("firmata", firmata.i2c_write(motor_shield.ADDRESS, bytes((motor_shield.PRE_SCALE, 0x1E)))),
    ],
)
def test_what_is_not_listed_does_not_leave(protocol: str, word: bytes) -> None:
    bench = Bench(protocol)
    assert bench.say(word) == []
    assert bench.reason.endswith("is not listed")


def test_a_board_with_a_loop_is_reported_no_more_than_the_top_speed() -> None:
    """11.8 rad/s are 190.4 counts a frame; alone to either side the sums allow less."""
    bench = Bench("ros-arduino-bridge")
    assert bench.say(speeds(0, -150, 150)) == [speeds(0, -150, 150)]
    assert bench.say(speeds(191, -150, 150), later=CYCLE) == [speeds(0, 0, 0)]
    assert bench.reason == "motor M1 (wheel at 0 degrees): 191 ticks is beyond 190"


@pytest.mark.parametrize(
    ("ticks", "sum_"),
    [
        ((0, -184, 184), ""),
        ((0, -185, 185), "speed ahead"),
        ((150, 150, 150), ""),
        ((190, 190, 190), ""),
    ],
)
def test_all_wheels_of_one_word_are_judged_together(ticks: tuple[int, int, int], sum_: str) -> None:
    bench = Bench("ros-arduino-bridge")
    sent = bench.say(speeds(*ticks))
    bound = {"speed ahead": 0.66, "turn rate": 1.9}
    per_tick = 6.283185307179586 / 3072 / 0.033
    turn = sum(ticks) * per_tick * 0.104167
    beyond = sum_ or ("turn rate" if turn > bound["turn rate"] else "")
    assert (sent == [speeds(*ticks)]) is not bool(beyond)
    if beyond:
        assert sent == [speeds(0, 0, 0)]
        assert beyond in bench.reason


@pytest.mark.parametrize("size", [1, 20])
@pytest.mark.parametrize("ways", [("f", "b"), ("b", "f")], ids="-".join)
@pytest.mark.parametrize("protocol", ["ros-arduino-bridge", "arduinoio"])
def test_a_motor_is_not_reversed_before_it_was_reported_0_for_half_a_cycle(
    protocol: str, ways: tuple[str, str], size: int
) -> None:
    first, second = ways
    reported = size if first == "f" else -size
    for wait, passes in ((0, False), (CYCLE // 2 - 1, False), (CYCLE // 2, True)):
        bench = Bench(protocol)
        if protocol == "arduinoio":
            assert pwm(1, size) in bench.say(way(1, first), pwm(1, size))
            bench.say(pwm(1, 0), later=CYCLE)
            sent = bench.say(way(1, second), pwm(1, size), later=wait)
            assert (pwm(1, size) in sent) is passes
        else:
            assert bench.say(speeds(reported, 0, 0)) == [speeds(reported, 0, 0)]
            bench.say(speeds(0, 0, 0), later=CYCLE)
            sent = bench.say(speeds(-reported, 0, 0), later=wait)
            assert (speeds(-reported, 0, 0) in sent) is passes
        if not passes:
            assert bench.reason.endswith("without standing at 0")


def test_a_direction_that_is_turned_under_power_is_a_reversal_too() -> None:
    bench = Bench("arduinoio")
    bench.say(way(2, "f"), pwm(2, 20))
    assert bench.say(way(2, "b"), later=CYCLE) == [pwm(2, 0)]


@pytest.mark.parametrize("ahead", [True, False])
@pytest.mark.parametrize("protocol", ["arduinoio", "firmata"])
def test_the_pwm_rises_by_its_slope_and_may_fall_at_once(protocol: str, *, ahead: bool) -> None:
    """600 counts a second: 30 in a cycle, and half a cycle of room."""
    bench = Bench(protocol)
    sign = "" if ahead else "-"
    one, other = (Pin.IN1, Pin.IN2) if ahead else (Pin.IN2, Pin.IN1)

    def reported(size: int) -> bytes:
        return pwm(1, size) if protocol == "arduinoio" else channel(1, Pin.PWM, size)

    ways = (way(1, "f" if ahead else "b"),)
    forward = ways if protocol == "arduinoio" else (channel(1, other, 0), channel(1, one, 1))
    assert reported(76) not in Bench(protocol).say(*forward, reported(76)), (
        "after a long rest: two cycles and a half"
    )
    assert bench.say(*forward, reported(75)) == [*forward, reported(75)]
    assert bench.say(reported(120), later=CYCLE) == [reported(120)]
    assert bench.say(reported(166), later=CYCLE) == [reported(0)]
    assert f"from {sign}120 to {sign}166 PWM at once, 45 is allowed" in bench.reason
    bench = Bench(protocol)
    bench.say(*forward, reported(75))
    assert bench.say(reported(0)) == [reported(0)]


@pytest.mark.parametrize(
    ("protocol", "moves", "word"),
    [
        ("ros-arduino-bridge", (speeds(20, 0, 0),), ros.encode("r")),
        ("arduinoio", (way(1, "f"), pwm(1, 20)), arduinoio.encode("H", 0)),
        (
            "firmata",
            (channel(1, Pin.IN1, 1), channel(1, Pin.PWM, 20)),
            firmata.i2c_write(motor_shield.ADDRESS, motor_shield.SET_UP[0]),
        ),
        (
            "mw",
            (mw.encode_request(messages.SetMotorSpeed(0, 0, 20, 1), 1),),
            mw.encode_request(messages.WriteCount(0, 0), 2),
        ),
    ],
)
def test_set_up_and_reset_are_for_a_robot_at_rest(
    protocol: str, moves: tuple[bytes, ...], word: bytes
) -> None:
    bench = Bench(protocol)
    assert bench.say(word) == [word]
    assert bench.reset()
    assert bench.say(*moves) == list(moves)
    assert not bench.reset()
    assert "a reset of the board while motor M1" in bench.reason
    bench = Bench(protocol)
    bench.say(*moves)
    assert word not in bench.say(word)
    assert "while motor M1 (wheel at 0 degrees) may move" in bench.reason


@pytest.mark.parametrize(
    ("protocol", "moves", "safe"),
    [
        ("ros-arduino-bridge", (speeds(20, 0, 0),), [speeds(0, 0, 0)]),
        ("arduinoio", (way(1, "f"), pwm(1, 20)), [pwm(1, 0)]),
        (
            "mw",
            (mw.encode_request(messages.SetMotorSpeed(0, 0, 20, 1), 1),),
            [mw.encode_request(messages.StopMotor(0, 0), 0) + bytes(57)],
        ),
        ("firmata", (channel(1, Pin.IN1, 1), channel(1, Pin.PWM, 20)), [channel(1, Pin.PWM, 0)]),
    ],
)
def test_the_guard_speaks_for_a_bridge_that_is_silent(
    protocol: str, moves: tuple[bytes, ...], safe: list[bytes]
) -> None:
    bench = Bench(protocol)
    bench.say(*moves)
    assert bench.say(later=3 * bench.cycle - 1) == []
    assert bench.say(later=1) == safe
    assert bench.reason.startswith(f"no set-point for {3 * bench.cycle // MILLISECOND} ms")


@pytest.mark.parametrize("robot", SHIELDS)
def test_the_guard_s_words_stop_every_motor_of_a_board(robot: str) -> None:
    """The bridge sends nothing more: each of the guard's commands must come to the board."""
    with driving(robot) as rig:
        station: Any = rig.bench.world._stations[BRIDGE]  # noqa: SLF001 - no fault of a mission does it
        guard = station.node.node
        node, guard.node = guard.node, Talker()
        try:
            rig.runs(2.0)
        finally:
            guard.node = node
        assert speed(rig) < 0.01


def test_mwprotocols_libraries_are_those_that_the_board_has_reported() -> None:
    bench = Bench("mw")
    info = messages.ServerInfo(17, 1, b"Mega2560", 0, (mw.SHIELD.encode(), mw.ENCODER.encode()))
    reported = mw.encode_answer(1, mw.row_of(messages.GetServerInfo()).answer.encode(info))
    bench.guard.receive(Packet("board", 0, reported), bench.now)
    own = mw.encode_request(messages.SetMotorSpeed(0, 0, 20, 1), 1, (mw.SHIELD, mw.ENCODER))
    assert bench.say(own) == [own]
    assert bench.guard.links["board"].axes[0].moving
    assert bench.talker.received == [reported]


def test_what_a_board_states_is_let_in() -> None:
    bench = Bench("ros-arduino-bridge")
    bench.guard.receive(Packet("board", 0, b"OK\r\n"), bench.now)
    assert bench.talker.received == [b"OK\r\n"]
    assert not bench.guard.links["board"].waiting


def test_a_motor_that_is_reported_a_way_and_no_pwm_does_not_move() -> None:
    bench = Bench("arduinoio")
    assert bench.say(way(1, "f")) == [way(1, "f")]
    assert bench.reset()


def test_it_is_known_which_motors_a_word_would_move() -> None:
    requested = (
        Bench("ros-arduino-bridge").guard.links["board"].requested_by(Packet("board", 0, speeds(1, 0, -2)))
    )
    assert [one.moves for one in requested.values()] == [True, False, True]
