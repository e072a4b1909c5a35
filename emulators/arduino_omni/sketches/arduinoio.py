"""The sketch motor_v2 of ArduinoIO: a byte at a time, no time-out, nothing that stops by itself.

Source: `families.motor_shield.wire.arduinoio`. A byte that does not fit ends the command in silence,
and is used up.

Where it is silent:
* setup() sets the shield up, which releases the motors.
* a counter that was never attached is at 0, and one that was detached keeps its count.
"""

from collections.abc import Callable, Mapping
from typing import Any, Final

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.jobs import Delay, OnBus, Say
from emulators.arduino_omni.mega.mega import CONVERSION, Mega
from emulators.arduino_omni.mega.pins import INPUT_PULLUP, Counter
from emulators.arduino_omni.shield.i2c import write
from emulators.arduino_omni.shield.motor_shield import PORTS
from firmware_bridge.families.motor_shield.wire import arduinoio as wire
from firmware_bridge.units import NEVER, Nanoseconds

COUNTER_BITS: Final = 16
STOCK_ENCODERS: Final = 2
"""Number of encoders in the stock sketch: the third has pins of its own, and no interrupt at them."""
MIDDLE: Final = 90
LARGEST_ANGLE: Final = 180
RUNS: Final[Mapping[int, library.RunArgument]] = {
    ord("f"): library.RunArgument.FORWARD,
    ord("b"): library.RunArgument.BACKWARD,
    ord("r"): library.RunArgument.RELEASE,
}


class ArduinoIoSketch:
    """One run of the sketch."""

    def __init__(self, mega: Mega, encoders: int = STOCK_ENCODERS) -> None:
        """Begin; where more encoders than the stock sketch's two count, all pins interrupt."""
        self._mega: Final = mega
        self._any_pin: Final = encoders > STOCK_ENCODERS
        self._commands: Final = wire.CommandReader()
        self._counters: dict[int, Counter] = {}
        self._kept: dict[int, int] = {}
        self._angles: dict[int, int] = {}
        self._servos: set[int] = set()
        self._handlers: Final[Mapping[str, Callable[..., Any]]] = {
            "0": mega.pins.configure,
            "1": self._read_pin,
            "2": mega.pins.write,
            "3": self._read_analog,
            "4": mega.pins.write_analog,
            "5": self._has_servo,
            "6": self._set_servo,
            "7": self._read_servo,
            "8": self._write_servo,
            "9": self._who,
            "A": self._speed,
            "B": self._run,
            "E": self._attach,
            "F": self._detach,
            "G": self._read_encoder,
            "H": self._zero_encoder,
            "X": self._say,
        }

    def setup(self) -> None:
        """Set the shield up."""
        self._mega.do_all(library.begin(self._address))

    @property
    def _address(self) -> int:
        return self._mega.shield.chip.address

    def due(self, now: Nanoseconds) -> Nanoseconds:
        """Return that nothing happens by itself."""
        del now
        return NEVER

    def loop(self, now: Nanoseconds) -> None:
        """Read up to the end of a command, and obey it."""
        del now
        while (byte := self._mega.serial.read()) >= 0:
            requested = self._commands.take(byte)
            if requested is not None:
                handler = self._handlers.get(requested.row.letter)
                if handler is not None:
                    handler(*requested.values)
                return

    def _say(self, number: int) -> None:
        self._mega.do(Say(wire.encode_answer(number)))

    def _who(self, _nine: int) -> None:
        self._say(wire.MOTOR_V2)

    # Pins

    def _read_pin(self, pin: int) -> None:
        self._say(self._mega.pins.read(pin))

    def _read_analog(self, channel: int) -> None:
        self._mega.do(Delay(CONVERSION))
        self._say(self._mega.pins.read_analog(channel))

    def _has_servo(self, pin: int) -> None:
        self._say(int(pin in self._servos))

    def _set_servo(self, pin: int, attached: int) -> None:
        if attached:
            self._servos.add(pin)
        else:
            self._servos.discard(pin)

    def _read_servo(self, pin: int) -> None:
        self._say(self._angles.get(pin, MIDDLE))

    def _write_servo(self, pin: int, angle: int) -> None:
        self._angles[pin] = min(angle, LARGEST_ANGLE)

    # Motors and encoders

    def _speed(self, motor: int, speed: int) -> None:
        self._mega.do(OnBus(write(self._address, library.set_speed(PORTS[motor - 1], speed))))

    def _run(self, motor: int, letter: int) -> None:
        command = RUNS.get(letter)
        if command is not None:
            writes = library.run(PORTS[motor - 1], command)
            self._mega.do_all(OnBus(write(self._address, data)) for data in writes)

    def _attach(self, encoder: int, pin_a: int, pin_b: int) -> None:
        for pin in (pin_a, pin_b):
            self._mega.pins.configure(pin, INPUT_PULLUP)
        self._counters[encoder] = Counter(
            self._mega.shafts, pin_a, pin_b, COUNTER_BITS, any_pin=self._any_pin
        )

    def _detach(self, encoder: int) -> None:
        counter = self._counters.pop(encoder, None)
        if counter is not None:
            self._kept[encoder] = counter.count

    def _read_encoder(self, encoder: int) -> None:
        counter = self._counters.get(encoder)
        self._say(self._kept.get(encoder, 0) if counter is None else counter.count)

    def _zero_encoder(self, encoder: int) -> None:
        self._kept[encoder] = 0
        if encoder in self._counters:
            self._counters[encoder].set(0)
