"""Faults of a board, by their names: their effect on its motors, and on its output."""

from math import log

import pytest

from emulators.arduino_omni.board import FIRMWARES, Board
from emulators.arduino_omni.commands.board import BOARD, alone_on_line
from emulators.arduino_omni.mega.motor_library import pre_scale
from emulators.arduino_omni.motors import MOTOR, SUPPLY_V, four_motors
from emulators.arduino_omni.shield.tb6612 import (
    AMBIENT_C,
    KELVIN_PER_WATT,
    ON_RESISTANCE,
    PEAK_CURRENT,
    SHUTDOWN_C,
    WARMS_IN_S,
)
from emulators.arduino_omni.shield_motors import ShieldMotor
from emulators.control.alone import alone
from emulators.control.words import fault_of, plan, planned
from emulators.family import Station, Way
from emulators.gateway import Cluster
from emulators.servo.axis import TICK
from emulators.servo.motor import DcMotor
from firmware_bridge.node import LINE_BACK, LINE_LOST, SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds
from fmu.errors import PlantError

READY = 2.0
SAGGED_V = 2.0
"""Below the need of the half bridges."""
STUCK = DcMotor(MOTOR.resistance, MOTOR.inductance, MOTOR.torque_constant, inertia=1e3, friction=0.0)
STALL = SUPPLY_V * 4080 / 4096 / (MOTOR.resistance + ON_RESISTANCE)


class Host:
    """Host at the other end of a faulty board, in virtual time."""

    def __init__(self, *faults: str, motor: DcMotor = MOTOR, auto_stop: int = 30_000) -> None:
        self.board = Board(FIRMWARES["ros-arduino-bridge"], four_motors(motor), auto_stop=auto_stop)
        self.node = Cluster({BOARD: self.board}, links={BOARD: {SERIAL: SERIAL}})
        names = four_motors().names
        motors = [ShieldMotor(name, self.board, port) for port, name in enumerate(names, start=1)]
        stations = {BOARD: Station(self.board, BOARD, {SERIAL: Way.LINE})}
        live = alone(alone_on_line(names), stations, motors, self.node, on_ptys=True)
        for text in faults:
            plan(live, [fault_of(live, planned(text))])
        self.received = b""
        self.lines: list[int] = []
        self.now: Nanoseconds = 0
        self._wake_at: Nanoseconds = 0
        self.run(READY)

    def run(self, seconds: float) -> None:
        until = self.now + round(seconds * SECOND)
        while self._wake_at <= until:
            self.now = max(self.now, self._wake_at)
            self._take(self.node.wake(self.now))
        self.now = until
        self.board.advance(until)

    def _take(self, reaction: Reaction) -> None:
        self.received += b"".join(packet.payload for packet in reaction.sent)
        self.lines += [packet.address for packet in reaction.sent if packet.address]
        self._wake_at = reaction.wake_at

    def ask(self, line: bytes, seconds: float = 0.1) -> bytes:
        self.received = b""
        self._take(self.node.receive(Packet(SERIAL, 0, line), self.now))
        self.run(seconds)
        return self.received

    def counts(self) -> list[int]:
        return [int(word) for word in self.ask(b"e\r").split()]

    def shut_down(self) -> list[bool]:
        return [chip.shut_down for chip in self.board.motors.chips]

    def most(self, motor: int, seconds: float) -> float:
        """Return the largest current while it runs on."""
        found = 0.0
        for _ in range(round(seconds * SECOND / TICK)):
            self.run(to_seconds(TICK))
            found = max(found, abs(self.board.motors.currents[motor]))
        return found


@pytest.mark.parametrize("speed", [255, -255])
def test_a_stalled_motor_takes_what_it_gets_unless_the_half_bridge_limits(speed: int) -> None:
    free, limited = Host(motor=STUCK), Host("current_limit", motor=STUCK)
    for it in (free, limited):
        it.ask(b"o %d 0 0\r" % speed, 0.02)
    assert free.most(0, 0.05) == pytest.approx(STALL, rel=1e-3)
    rise = SUPPLY_V / MOTOR.inductance * to_seconds(TICK)
    assert PEAK_CURRENT * 0.9 < limited.most(0, 0.05) < PEAK_CURRENT + rise


def test_a_half_bridge_too_hot_shuts_both_its_motors_down_and_comes_back() -> None:
    it = Host("over_temperature@3", motor=STUCK)
    it.ask(b"o 255 40 40\r", 1.0 - 0.1)
    assert it.board.motors.currents[0] == pytest.approx(STALL, rel=1e-3)
    small = STALL * 40 / 255
    watts = ON_RESISTANCE * (STALL**2 + small**2)
    shuts = -WARMS_IN_S * log(1 - (SHUTDOWN_C - AMBIENT_C) / (KELVIN_PER_WATT * watts))
    it.run(0.1 + shuts - 0.01)
    assert it.shut_down() == [False, False]
    it.run(0.03)
    assert it.shut_down() == [True, False]
    assert it.board.motors.currents[:2] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert it.board.motors.currents[2] == pytest.approx(small, rel=1e-3)
    cools = WARMS_IN_S * log(150 / 130)
    it.run(cools)
    assert it.board.motors.currents[0] > 1.0


def test_a_cable_that_is_off_for_a_while_leaves_its_motor_alone() -> None:
    it = Host("motor_cable_off,node=M2@3-4")
    it.ask(b"o 100 100 0\r", 0.9)
    assert it.board.motors.speeds[1] == pytest.approx(it.board.motors.speeds[0])
    it.run(0.5)
    assert it.board.motors.currents[1] == pytest.approx(0.0, abs=1e-3)
    assert it.board.motors.speeds[1] < it.board.motors.speeds[0] - 1.0
    it.run(3.0)
    assert it.board.motors.speeds[1] == pytest.approx(it.board.motors.speeds[0], rel=1e-3)


def test_with_too_low_a_supply_of_the_motors_the_half_bridges_are_off_and_the_board_lives_on() -> None:
    it = Host(f"motor_supply_sag,to_v={SAGGED_V}@3-4")
    it.ask(b"o 100 -100 0\r", 0.9)
    before = it.board.motors.speeds[0]
    assert it.ask(b"b\r", 0.5) == b"57600\r\n"
    assert it.board.motors.currents[:2] == pytest.approx([0.0, 0.0], abs=1e-3)
    assert it.board.motors.supply == SAGGED_V
    assert it.board.motors.speeds[0] < before - 1.0
    it.run(3.0)
    assert it.board.motors.speeds[0] == pytest.approx(before, rel=1e-3)


def test_nothing_is_lifted_where_the_plant_has_no_floor() -> None:
    with pytest.raises(PlantError, match="no input lifted_M2: nothing can hoist it"):
        Host("load_lifted,node=M2@1")


@pytest.mark.parametrize("fault", ["encoder_cable_off", "encoder_swapped"])
def test_a_motor_without_an_encoder_has_no_fault_of_one(fault: str) -> None:
    with pytest.raises(PlantError, match="M4 has no encoder"):
        Host(f"{fault},node=M4@1")


def test_a_shaft_that_is_blocked_for_a_while_stands_and_draws_a_stalls_current() -> None:
    it = Host("shaft_blocked,node=M2@3-4")
    it.ask(b"o 100 100 0\r", 1.2)
    assert it.board.motors.speeds[1] == 0.0
    assert it.board.motors.currents[1] > 1.5
    assert it.board.motors.speeds[0] > 10
    it.run(4.0)
    assert it.board.motors.speeds[1] == pytest.approx(it.board.motors.speeds[0], rel=1e-3)


def test_a_firmware_that_hangs_runs_on_and_sends_nothing_until_it_is_reset() -> None:
    it = Host("board_hangs@3", "board_reset@4")
    it.ask(b"o 100 0 0\r", 1.2)
    speed = it.board.motors.speeds[0]
    assert it.ask(b"m 0 0 0\r", 0.6) == b""
    assert it.board.motors.speeds[0] == pytest.approx(speed, rel=0.02)
    it.run(3.5)
    assert it.ask(b"b\r") == b"57600\r\n"


def test_a_dead_encoder_stands_on_counter_and_pins_while_its_shaft_turns() -> None:
    it = Host("encoder_cable_off,node=M1@3-4")
    it.ask(b"o 100 100 0\r", 1.1)
    first, second, _ = it.counts()
    levels = [it.board.motors.level(pin) for pin in (2, 3)]
    it.run(0.5)
    assert it.board.motors.speeds[0] > 10
    again, further, _ = it.counts()
    assert (again, further > second + 100) == (first, True)
    assert [it.board.motors.level(pin) for pin in (2, 3)] == levels
    it.run(1.0)
    assert it.counts()[0] > first + 100


def test_a_brown_out_silences_the_board_while_the_shield_goes_on() -> None:
    it = Host("board_brown_out@3-4")
    it.ask(b"o 100 0 0\r", 1.2)
    speed = it.board.motors.speeds[0]
    assert it.ask(b"b\r\x1b", 0.7) == b""
    assert it.board.motors.speeds[0] == pytest.approx(speed, rel=0.02)
    it.run(1.0)  # in the boot loader
    assert it.board.motors.speeds[0] == pytest.approx(speed, rel=0.02)
    it.run(2.0)
    assert it.board.motors.speeds[0] == 0.0
    assert it.ask(b"b\r") == b"57600\r\n"


def test_without_power_the_shield_forgets_and_the_motor_coasts() -> None:
    it = Host("board_unpowered@3-4")
    it.ask(b"o 100 0 0\r", 1.05)
    assert it.board.motors.currents[0] == pytest.approx(0.0, abs=1e-3)
    assert it.ask(b"b\r") == b""
    it.run(2.5)
    assert it.ask(b"b\r") == b"57600\r\n"


def test_a_cable_that_is_out_carries_nothing_and_the_sketch_lives_on() -> None:
    it = Host("serial_unplugged@3-4")
    it.ask(b"o 100 0 0\r", 0.5)
    speed = it.board.motors.speeds[0]
    it.run(0.7)
    assert it.lines == [LINE_LOST]
    assert it.ask(b"o 0 0 0\r", 0.5) == b""
    assert it.board.motors.speeds[0] == pytest.approx(speed, rel=0.02), "it never received that"
    it.run(0.5)
    assert it.lines == [LINE_LOST, LINE_BACK]
    assert it.ask(b"b\r") == b"57600\r\n"


# As avr-gcc 5.4 and avr-libc have it, run by simavr over all 65,536 frequencies: both sides of some steps.
@pytest.mark.parametrize(
    ("hertz", "written"),
    [
        (0, 0),
        (1044, 5),
        (1233, 5),
        (1234, 4),
        (1507, 4),
        (1508, 3),
        (1600, 3),
        (13563, 0),
        (13564, 255),
    ],
)
def test_the_shields_frequency_is_divided_in_floats(hertz: int, written: int) -> None:
    assert pre_scale(hertz) == written
