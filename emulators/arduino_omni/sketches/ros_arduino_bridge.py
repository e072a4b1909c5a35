"""The sketch ros_arduino_bridge with three motors on the motor shield: a loop of 30 Hz, and an auto-stop.

Sources: hbrobotics/ros_arduino_bridge, indigo-devel: the sketch and its headers; the shield and the third
motor are ours, as `emulators/arduino_omni/sketch` has them for a real board.

Ours differs from the stock sketch in two points. It executes one command per turn, so that a flood of
commands holds up neither loop nor auto-stop. And a loop begins from the motors' present positions.

Where it is silent:
* setup() releases the motors and sets the shield up, before it listens.
* pins on which wheels, host or shield hang are none that a command may have.
* a speed of 0 is PWM 0 and then RELEASE; else PWM, then the direction.
* the auto-stop writes to the shield once, and not again and again.
* characters of an argument beyond its 15 are lost; the sketch would write past its end.
* arguments beyond the last are lost, up to the end of the line.
* servos are not compiled: their commands are invalid; a ping finds nothing for a second, and returns 0.
* the third encoder counts by pin-change interrupts.
"""

from collections.abc import Callable, Mapping
from typing import Final

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.arithmetic import atoi, int16
from emulators.arduino_omni.mega.clock import WORD as CLOCK_WORD
from emulators.arduino_omni.mega.jobs import Delay, Say
from emulators.arduino_omni.mega.mega import CONVERSION, Mega
from emulators.arduino_omni.mega.pins import (
    BUSY_PINS,
    ENCODER_PINS,
    INPUT,
    INPUT_PULLUP,
    OUTPUT,
    PINS,
    Counter,
)
from emulators.arduino_omni.shield.motor_shield import PORTS
from emulators.arduino_omni.sketches.motor_pid import MAX_PWM, Gains, MotorPid
from firmware_bridge.families.motor_shield.wire import ros_arduino_bridge as wire
from firmware_bridge.units import SECOND, Nanoseconds

PID_INTERVAL: Final = 1_000 // 30
"""ms; the division is the sketch's."""
AUTO_STOP: Final = 2_000
"""ms, of the stock sketch."""
NO_ECHO: Final[Nanoseconds] = SECOND
"""pulseIn's default."""
GAINS: Final = 4
_CR: Final = 0x0D
_SPACE: Final = 0x20
_Handler = Callable[["RosSketch"], None]


class RosSketch:
    """One run of the sketch; `auto_stop` in ms."""

    def __init__(self, mega: Mega, motors: int = 3, auto_stop: int = AUTO_STOP) -> None:
        self._mega: Final = mega
        self._motors: Final = motors
        self._auto_stop: Final = auto_stop
        self._gains: Final = Gains()
        self.pids: Final = [MotorPid(self._gains) for _ in range(motors)]
        self._counters: Final = [
            Counter(mega.shafts, a, b, 32, any_pin=True) for a, b in ENCODER_PINS[:motors]
        ]
        self._kept: Final = BUSY_PINS.union(*ENCODER_PINS[:motors])
        self._letter = 0
        self._argument = 0
        self._words: list[bytearray] = []
        self._moving = False
        self._obeyed = False
        """True if a command was executed in the turn before: then loop and auto-stop come first."""
        self._driven = False
        """True if a motor may run that the auto-stop has to stop."""
        self._commanded_at = 0
        self._next_frame = PID_INTERVAL
        self._now: Nanoseconds = 0
        self._forget()

    def setup(self) -> None:
        """Release the motors."""
        for pins in ENCODER_PINS[: self._motors]:
            for pin in pins:
                self._mega.pins.configure(pin, INPUT_PULLUP)
        # First of all: after a reset of the board alone the shield still drives its motors.
        self._mega.do(library.release_all(self._address))
        self._mega.do_all(library.begin(self._address))

    @property
    def _address(self) -> int:
        return self._mega.shield.chip.address

    def due(self, now: Nanoseconds) -> Nanoseconds:
        """Return when millis() has passed the next frame, or the auto-stop's time."""
        clock = self._mega.clock
        # The sketch compares with "later than": a frame is due 1 ms behind its number.
        frame = clock.shows((self._next_frame + 1) % CLOCK_WORD, now)
        if not self._driven:
            return frame
        return min(frame, clock.shows((self._commanded_at + self._auto_stop + 1) % CLOCK_WORD, now))

    def loop(self, now: Nanoseconds) -> None:
        """Read and obey what has arrived, close the frame that is over, and stop where no one has spoken."""
        self._now = now
        while not self._obeyed and (byte := self._mega.serial.read()) >= 0:
            if self._read(byte):
                self._obeyed = True
                return  # until that is done
        self._obeyed = False
        millis = self._mega.clock.millis(now)
        # millis() wraps after 49.7 days: the signed difference decides, not the value.
        if 0 < (millis - self._next_frame) % CLOCK_WORD < CLOCK_WORD // 2:
            self._frame()
            self._next_frame = (self._next_frame + PID_INTERVAL) % CLOCK_WORD
        if self._driven and (millis - self._commanded_at) % CLOCK_WORD > self._auto_stop:
            self._drive([0] * self._motors)
            self._moving = self._driven = False

    # A line

    def _read(self, byte: int) -> bool:
        """Take a character; return whether a command was obeyed."""
        if byte == _CR:
            self._obey()
            self._forget()
            return True
        if byte == _SPACE:
            self._argument += 1
        elif self._argument == 0:
            self._letter = byte
        elif self._argument <= len(self._words) and len(self._words[self._argument - 1]) < wire.WORD - 1:
            self._words[self._argument - 1].append(byte)
        return False

    def _forget(self) -> None:
        self._letter = self._argument = 0
        self._words = [bytearray() for _ in range(max(self._motors, 2))]

    def _obey(self) -> None:
        handler = _HANDLERS.get(chr(self._letter))
        if handler is None:
            self._say(wire.INVALID)
        else:
            handler(self)

    def _say(self, text: object) -> None:
        self._mega.do(Say(str(text).encode() + wire.LINE_END))

    def _number(self, place: int) -> int:
        return atoi(bytes(self._words[place]))

    def _pin(self) -> int:
        """Return the pin of a command, or one that the board has not."""
        pin = self._number(0) & 0xFF
        return PINS if pin in self._kept else pin

    # Commands

    def read_analog(self) -> None:
        """Answer `a`."""
        self._mega.do(Delay(CONVERSION))
        self._say(self._mega.pins.read_analog(self._number(0) & 0xFF))

    def say_baud(self) -> None:
        """Answer `b`."""
        self._say(wire.BAUD)

    def configure_pin(self) -> None:
        """Obey `c`."""
        mode = self._number(1)
        if mode in {INPUT, OUTPUT}:
            self._mega.pins.configure(self._pin(), mode)
        self._say(wire.OK)

    def read_pin(self) -> None:
        """Answer `d`."""
        self._say(self._mega.pins.read(self._number(0) & 0xFF))

    def read_encoders(self) -> None:
        """Answer `e`."""
        self._say(" ".join(str(counter.count) for counter in self._counters))

    def set_speeds(self) -> None:
        """Obey `m`."""
        self._commanded_at = self._mega.clock.millis(self._now)
        targets = [self._number(motor) for motor in range(self._motors)]
        if any(targets):
            if not self._moving:
                # From the present counts: what was turned since the last loop is no speed.
                self._reset_pids()
            self._moving = self._driven = True
        else:
            self._drive(targets)
            self._reset_pids()
            self._moving = self._driven = False
        for pid, target in zip(self.pids, targets, strict=True):
            pid.target = target
        self._say(wire.OK)

    def set_pwm(self) -> None:
        """Obey `o`: the loop is off until the next speed."""
        self._commanded_at = self._mega.clock.millis(self._now)
        self._reset_pids()
        self._moving = False
        speeds = [self._number(motor) for motor in range(self._motors)]
        # Raw PWM has an auto-stop, too.
        self._driven = any(speeds)
        self._drive(speeds)
        self._say(wire.OK)

    def ping(self) -> None:
        """Answer `p`."""
        pin, pins = self._pin(), self._mega.pins
        pins.write(pin, 0)
        pins.configure(pin, INPUT)
        self._mega.do(Delay(NO_ECHO))
        self._say(0)

    def reset_encoders(self) -> None:
        """Obey `r`."""
        for counter in self._counters:
            # The loops must begin again, too: the jump of the counts would be taken for a speed.
            counter.set(0)
        self._reset_pids()
        self._say(wire.OK)

    def set_gains(self) -> None:
        """Obey `u`: what is not given stays."""
        text = bytes(self._words[0]).partition(b"\0")[0]
        given = [atoi(it) for it in text.split(b":") if it][:GAINS]
        gains = self._gains
        before = (gains.kp, gains.kd, gains.ki, gains.ko)
        gains.kp, gains.kd, gains.ki, gains.ko = (*given, *before[len(given) :])
        self._say(wire.OK)

    def write_pin(self) -> None:
        """Obey `w`."""
        level = self._number(1)
        if level in {0, 1}:
            self._mega.pins.write(self._pin(), level)
        self._say(wire.OK)

    def write_analog(self) -> None:
        """Obey `x`."""
        self._mega.pins.write_analog(self._pin(), self._number(1))
        self._say(wire.OK)

    # The loop

    def _frame(self) -> None:
        if self._moving:
            counts = [counter.count for counter in self._counters]
            self._drive([pid.update(count) for pid, count in zip(self.pids, counts, strict=True)])
        # Once after the loop has ended, as in the original's updatePID().
        elif any(pid.turned for pid in self.pids):
            self._reset_pids()

    def _reset_pids(self) -> None:
        for pid, counter in zip(self.pids, self._counters, strict=True):
            pid.reset(counter.count)

    def _drive(self, speeds: list[int]) -> None:
        for port, speed in zip(PORTS, speeds, strict=False):
            size = min(abs(int16(speed)), MAX_PWM)
            turned = library.RunArgument.BACKWARD if speed < 0 else library.RunArgument.FORWARD
            command = turned if size else library.RunArgument.RELEASE
            self._mega.do_all(library.drive(self._address, port, size, command))


_HANDLERS: Final[Mapping[str, _Handler]] = {
    "a": RosSketch.read_analog,
    "b": RosSketch.say_baud,
    "c": RosSketch.configure_pin,
    "d": RosSketch.read_pin,
    "e": RosSketch.read_encoders,
    "m": RosSketch.set_speeds,
    "o": RosSketch.set_pwm,
    "p": RosSketch.ping,
    "r": RosSketch.reset_encoders,
    "u": RosSketch.set_gains,
    "w": RosSketch.write_pin,
    "x": RosSketch.write_analog,
}
"""Commands that the sketch has compiled, by their letters."""
