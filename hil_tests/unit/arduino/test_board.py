"""A whole board in virtual time: each firmware turns a motor and counts it; the command's mistakes."""

from math import floor, sqrt, tau

import pytest
from typer.testing import CliRunner

from emulators.arduino_omni.board import FIRMWARES, MOVES_EVERY, Board
from emulators.arduino_omni.fmu_load import fmu_load
from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.motors import COUNTS_PER_TURN, MotorLoad, four_motors
from firmware_bridge.cli import program
from firmware_bridge.families.motor_shield.wire import mw, mw_messages
from firmware_bridge.node import DTR_UP, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds
from fmu.build import ensure
from fmu.errors import PlantError
from fmu.plant import FmuPlant


class Host:
    """A board that is plugged in, and its output."""

    def __init__(
        self,
        firmware: str,
        encoders: int | None = None,
        auto_stop: int | None = None,
        load: MotorLoad | None = None,
    ) -> None:
        self.board = Board(FIRMWARES[firmware], load or four_motors(), encoders=encoders, auto_stop=auto_stop)
        self.received = bytearray()
        self.now: Nanoseconds = 0
        self._wake_at: Nanoseconds = 0
        self.run(4 * SECOND)  # Firmata blinks its version
        self.received.clear()

    def run(self, duration: Nanoseconds) -> None:
        until = self.now + duration
        while self._wake_at <= until:
            self.now = max(self.now, self._wake_at)
            self._take(self.board.wake(self.now))
        self.now = until

    def _take(self, reaction: Reaction) -> None:
        assert reaction.wake_at <= self.now + MOVES_EVERY
        self._wake_at = reaction.wake_at
        for packet in reaction.sent:
            self.received += packet.payload

    def send(self, data: bytes, address: int = 0) -> None:
        self._take(self.board.receive(Packet(SERIAL, address, data), self.now))

    def ask(self, data: bytes, wait: Nanoseconds = 100 * MILLISECOND) -> bytes:
        self.received.clear()
        self.send(data)
        self.run(wait)
        return bytes(self.received)

    def turned(self, motor: int = 0) -> float:
        """Return how far a shaft has come, in counts of its encoder."""
        return self.board.motors.angles[motor] / tau * COUNTS_PER_TURN


def test_the_loop_on_the_board_holds_its_speed_on_the_motor() -> None:
    it = Host("ros-arduino-bridge")
    assert it.ask(b"m 20 -30 40\r") == b"OK\r\n"
    it.run(SECOND)
    before = [int(word) for word in it.ask(b"e\r").split()]
    began = it.now
    it.run(500 * MILLISECOND)
    after = [int(word) for word in it.ask(b"e\r").split()]
    frames = (it.now - began) / (33 * MILLISECOND)
    rates = [(new - old) / frames for old, new in zip(before, after, strict=True)]
    assert rates == pytest.approx([20, -30, 40], abs=2.5)


def test_what_is_read_is_where_the_shaft_is() -> None:
    it = Host("ros-arduino-bridge")
    it.ask(b"o 90 0 0\r")
    it.received.clear()
    it.send(b"e\r")
    while not it.received.endswith(b"\r\n"):
        it.run(MILLISECOND)
    # The answer takes 5 ms on its way, and in that the shaft goes on.
    count = int(it.received.split()[0])
    assert 0.0 < it.turned() - count < it.board.motors.speeds[0] / tau * COUNTS_PER_TURN * 0.012


def test_a_machine_that_was_busy_changes_nothing_on_the_board() -> None:
    prompt, late = Host("ros-arduino-bridge"), Host("ros-arduino-bridge")
    for it in (prompt, late):
        it.send(b"m 25 -40 0\r")
    prompt.run(SECOND)
    prompt.board.wake(prompt.now)
    for _ in range(10):
        late.now += 100 * MILLISECOND
        late.board.wake(late.now)
    assert list(late.board.motors.angles) == list(prompt.board.motors.angles)
    assert late.board.motors.edges == prompt.board.motors.edges != [0, 0, 0]


class Watched(Host):
    """Woken every so often besides, as by someone who looks at each byte."""

    def __init__(self, firmware: str, every: Nanoseconds) -> None:
        self.every = SECOND
        self.reported: list[tuple[Nanoseconds, bytes]] = []
        super().__init__(firmware, auto_stop=120, load=fmu_load(ensure("rome_base")))
        self.reported.clear()
        self.every = every

    def _take(self, reaction: Reaction) -> None:
        self.reported += [(self.now, packet.payload) for packet in reaction.sent]
        super()._take(Reaction(reaction.sent, min(reaction.wake_at, self.now + self.every)))


# Half lines, more than a ring holds, more than the host waits for, silence until the auto-stop, and a reset.
STATED = (
    *(b"m 60 -", b"60 40\re\r", b"z\r" * 20, b"x" * 90, b"\re\rb", b"\r\r"),
    *(b"u 30:20:1:50\re\r" * 4, b"", b"e\r"),
)
SHIELD = tuple(
    mw.encode_request(it, 0)
    for it in (
        mw_messages.CreateShield(0, 0x60, library.DEFAULT_HZ),
        mw_messages.CreateMotor(0, 0),
        mw_messages.StartMotor(0, 0, 150, 1),
    )
)
DIALOGUES = {
    "ros-arduino-bridge": (STATED, b"m 9 9 9\re\r"),
    "mw": ((*SHIELD[:2], SHIELD[2][:4], SHIELD[2][4:], b"".join(SHIELD) * 4), SHIELD[0]),
    "arduinoio": ((b"A1\x96B1f", b"E0", b"cd", b"G0" * 40, b"99" * 30), b"99"),
    "firmata": ((b"\xf0\x79\xf7" * 5, b"\xf9", b"\xf0\x6b", b"\xf7"), b"\xf9"),
}
"""Packets sent to each firmware, and the last one."""


@pytest.mark.parametrize("firmware", FIRMWARES)
def test_a_host_receives_the_same_at_the_same_time_whichever_client_looks_at_the_board(firmware: str) -> None:
    dialogue, last = DIALOGUES[firmware]
    seldom, often = Watched(firmware, SECOND), Watched(firmware, 79 * MICROSECOND)
    for it in (seldom, often):
        for stated in dialogue:
            it.send(stated)
            it.run(70 * MILLISECOND + 1_234)
        it.board.reset(it.now)
        it.run(1_200 * MILLISECOND)
        it.send(last)
        it.run(50 * MILLISECOND)
        it.board.advance(it.now)
    assert len(seldom.reported) > 3
    assert seldom.reported == often.reported
    assert list(seldom.board.motors.angles) == list(often.board.motors.angles)


def test_auto_stop_stops_the_motor_after_its_time_and_not_before() -> None:
    it = Host("ros-arduino-bridge", auto_stop=500)
    it.ask(b"m 40 0 0\r", 480 * MILLISECOND)
    assert it.board.motors.speeds[0] > 50
    it.run(SECOND)
    assert it.board.motors.speeds[0] == 0.0


def test_a_reset_in_mid_motion_runs_on_until_the_sketch_sets_the_shield_up() -> None:
    it = Host("ros-arduino-bridge")
    it.ask(b"o 200 0 0\r", SECOND)
    speed = it.board.motors.speeds[0]
    it.send(b"", DTR_UP)
    it.run(SECOND)
    assert it.board.motors.speeds[0] == pytest.approx(speed, rel=0.01)
    it.run(3 * SECOND)
    assert it.board.motors.speeds[0] == 0.0


@pytest.mark.parametrize(("encoders", "counts"), [(2, False), (3, True)])
def test_arduinoio_counts_the_third_wheel_only_where_it_is_not_stock(encoders: int, *, counts: bool) -> None:
    it = Host("arduinoio", encoders)
    third = bytes((97 + 10, 97 + 11))
    for line in (b"E0cd", b"E2" + third, b"A1\x80", b"B1f", b"A3\x80", b"B3f"):
        it.ask(line)
    first, last = int(it.ask(b"G0")), int(it.ask(b"G2"))
    assert first > 100
    assert it.turned(2) > 100
    assert (last > 100) is counts


def test_firmata_turns_a_motor_by_the_registers_and_reads_its_encoder() -> None:
    it = Host("firmata", 2)

    def i2c(*data: int) -> bytes:
        pairs = bytes(half for byte in data for half in (byte & 0x7F, byte >> 7))
        return bytes((0xF0, 0x76, 0x60, 0x00)) + pairs + b"\xf7"

    it.ask(bytes((0xF0, 0x78, 0, 0, 0xF7)))
    it.ask(bytes((0xF0, 0x61, 0, 0, 2, 3, 0xF7)))
    it.ask(i2c(0x00, 0x21))  # awake, registers one after the other
    it.ask(i2c(6 + 4 * 8, 0, 0, 0, 8))  # PWM of M1: half
    it.ask(i2c(6 + 4 * 10, 0, 16, 0, 0), SECOND)  # IN1 high
    before = it.turned()
    stated = it.ask(bytes((0xF0, 0x61, 1, 0, 0xF7)))
    assert stated[:3] == bytes((0xF0, 0x61, 0x00))
    count = sum(byte << 7 * place for place, byte in enumerate(stated[3:7]))
    assert 1000 < before < count < it.turned()


# P of the base's own frame: rims = P (u, q, W), rows -sin z, cos z, L at 0, 120 and 240 degrees.
def test_three_wheels_turn_a_base_by_its_kinematics() -> None:
    load = fmu_load(ensure("rome_base"))
    plant = load.plant
    assert isinstance(plant, FmuPlant)
    assert load.names == ("one", "two", "three")
    it = Host("ros-arduino-bridge", load=load)
    assert it.board.motors.supply == pytest.approx(12.0)
    radius, gear, distance = (plant.read(it) for it in ("wheel_radius", "gear_wheel", "wheel_distance"))
    it.ask(b"m 40 40 40\r", SECOND)
    assert it.board.motors.supply < 12.0
    one, two, three = (speed / gear * radius for speed in it.board.motors.speeds)
    assert plant.read("yaw_rate") == pytest.approx((one + two + three) / (3 * distance))
    assert plant.read("yaw_rate") == pytest.approx(0.826, abs=0.04)  # 40 counts in 33 ms
    assert plant.read("speed") == pytest.approx(0.0, abs=0.005)
    it.ask(b"m 0 -40 40\r", SECOND)  # along the base's own x
    one, two, three = (speed / gear * radius for speed in it.board.motors.speeds)
    assert plant.read("speed") == pytest.approx((three - two) / sqrt(3))
    assert plant.read("speed") > 0.1
    assert plant.read("speed_sideways") == pytest.approx((2 * one - two - three) / 3, abs=1e-9)
    counts = [floor(angle / tau * COUNTS_PER_TURN) for angle in it.board.motors.angles]
    assert it.board.motors.edges == counts


def test_an_fmu_without_axes_for_a_shield_is_refused() -> None:
    rars = ensure("rars")
    assert len(fmu_load(rars).names) == 4
    assert fmu_load(rars, ("lift", "left")).names == ("lift", "left")
    with pytest.raises(PlantError, match="lacks the input 'voltage_third'"):
        fmu_load(rars, ("left", "third"))
    with pytest.raises(PlantError, match="has 4 terminals, and these are 5 axes"):
        fmu_load(rars, ("a", "b", "c", "d", "e"))


@pytest.mark.parametrize(
    ("words", "reported"),
    [
        (("--firmware", "grbl"), "there are: mw, ros-arduino-bridge, arduinoio, firmata"),
        (("--firmware", "mw", "--encoders", "4"), "--encoders 4: mw counts 2 or 3"),
        (("--firmware", "firmata", "--encoders", "3"), "--encoders 3: firmata counts 0 or 2"),
        (("--firmware", "mw", "--auto-stop-ms", "500"), "mw has no auto-stop; its motors run on"),
        (("--firmware", "mw", "--serial", "/dev/nowhere"), "/dev/nowhere"),
        (("--firmware", "mw", "--serial", "/dev/null", "--serial-link", "x"), "only a pseudo-terminal"),
        (("--firmware", "mw", "--axes", "a,b"), "name one by --plant"),
        (
            ("--firmware", "mw", "--fault", "rust"),
            "--fault rust: no such fault as 'rust'; there are: encoder_swapped, board_silent",
        ),
        (("--firmware", "mw", "--serial", "/dev/null", "--reset-on-open"), "only --serial pty needs it"),
        (("--firmware", "mw", "--serial-link", "/"), "cannot make the link /"),
        (("--firmware", "mw", "--plant", "nowhere.fmu"), "nowhere.fmu: there is no such file"),
        (("--firmware", "mw", "--plant", "rome_bas"), "did you mean 'rome_base'"),
    ],
)
def test_mistakes_are_reported_in_one_line(words: tuple[str, ...], reported: str) -> None:
    result = CliRunner().invoke(program, ["emulate", "board", *words])
    assert result.exit_code == 2, result.output
    (line,) = result.stderr.splitlines()
    assert reported in line


def test_the_help_states_that_opening_resets_nothing() -> None:
    help_ = " ".join(CliRunner().invoke(program, ["emulate", "board", "--help"]).output.split())
    assert "resets nothing" in help_.replace("│ ", "")
