"""The board's 70 pins as a sketch sees them, and the shafts whose encoders are wired to some of them.

Sources: ArduinoCore-avr, variants/mega/pins_arduino.h: 54 to 69 are A0 to A15, 20 and 21 are I2C; external
interrupts on 2, 3, 18 to 21, PWM on 2 to 13 and 44 to 46. The board's diagram: 0 and 1 are the host's lines,
20 and 21 have resistors to 5 V, and so all four idle high.

Where they are silent:
* an open input reads low, with its pull-up high; analogRead of it gives 0.
* numbers that no pin has do nothing and read 0: the core takes what lies behind the end of its tables.
* the third motor's encoder is on 10 and 11, where the chip has pin-change interrupts only.
"""

from dataclasses import dataclass
from typing import Final

from emulators.arduino_omni.mega.arithmetic import wrapped
from firmware_bridge.units import Nanoseconds

PINS: Final = 70
FIRST_ANALOG: Final = 54
ANALOG: Final = 16
LED: Final = 13
PWM_PINS: Final = frozenset({*range(2, 14), *range(44, 47)})
BUSY_PINS: Final = frozenset({0, 1, 20, 21})
"""Serial and I2C."""
HALF: Final = 128
"""Least value of analogWrite() that makes a pin without PWM high."""
EXTERNAL_INTERRUPTS: Final = frozenset({2, 3, 18, 19, 20, 21})
ENCODER_PINS: Final = ((2, 3), (18, 19), (10, 11))
"""The pins of channels A and B, motor by motor."""

INPUT: Final = 0
OUTPUT: Final = 1
INPUT_PULLUP: Final = 2


class Pins:
    """Modes and levels; numbers that no pin has do nothing and read 0."""

    def __init__(self, shafts: "Shafts | None" = None) -> None:
        self._shafts: Final = Shafts() if shafts is None else shafts
        self.driven: dict[int, bool] = dict.fromkeys(BUSY_PINS, True)
        """Inputs that someone outside drives; it outlives a reset."""
        self.analog = [0] * ANALOG
        """Result of analogRead for each pin, 0 to 1023; it outlives a reset."""
        self.modes = bytearray(PINS)
        self.duties: dict[int, int] = {}
        """Pins with analogWrite on them, 1 to 254."""
        self._latches = bytearray(PINS)

    def reset(self) -> None:
        """Make all pins inputs."""
        self.modes[:] = bytes(PINS)
        self._latches[:] = bytes(PINS)
        self.duties.clear()

    def configure(self, pin: int, mode: int) -> None:
        """Configure a pin as pinMode() does: any mode that is neither input has the pin driven."""
        if pin < PINS:
            self.modes[pin] = mode if mode in {INPUT, INPUT_PULLUP} else OUTPUT
            if mode in {INPUT, INPUT_PULLUP}:
                self._latches[pin] = int(mode == INPUT_PULLUP)

    def write(self, pin: int, level: int) -> None:
        """Write a pin as digitalWrite() does: it ends a PWM, and on an input switches the pull-up."""
        if pin < PINS:
            self.duties.pop(pin, None)
            self._latches[pin] = int(level != 0)

    def write_analog(self, pin: int, value: int) -> None:
        """Write a pin as analogWrite() does: it becomes an output; at both ends a level."""
        self.configure(pin, OUTPUT)
        if pin < PINS:
            if value in {0, 255} or pin not in PWM_PINS:
                self.write(pin, int(value >= HALF))
            else:
                self.duties[pin] = value & 0xFF

    def read(self, pin: int) -> int:
        """Read a pin as digitalRead() does."""
        if pin >= PINS:
            return 0
        # The core's digitalRead() ends a PWM on that pin, too.
        self.duties.pop(pin, None)
        if self.modes[pin] == OUTPUT:
            return self._latches[pin]
        level = self.driven.get(pin, self._shafts.level(pin))
        return self._latches[pin] if level is None else int(level)

    def read_analog(self, pin: int) -> int:
        """Read as analogRead() does: a pin's number or a channel's; the multiplexer has sixteen."""
        return self.analog[(pin - FIRST_ANALOG if pin >= FIRST_ANALOG else pin) % ANALOG]


class Shafts:
    """Positions of the motors' encoders, in edges of both channels, since the start of the simulation."""

    def __init__(self, wiring: tuple[tuple[int, int], ...] = ENCODER_PINS) -> None:
        self._edges = [0] * len(wiring)
        self._wiring: Final = wiring

    @property
    def edges(self) -> list[int]:
        """Set by what turns the motors; forwards is A before B."""
        return self._edges

    def reach(self, now: Nanoseconds) -> None:
        """Advance to `now`, before anything is done then; these shafts are not turned."""

    def level(self, pin: int) -> bool | None:
        """Return what an encoder puts on a pin; None where none is: here on no pin."""
        del pin
        return None

    def motor(self, pin_a: int, pin_b: int) -> tuple[int, int]:
        """Return which motor is on these pins, and its sign there; (-1, 0) for none."""
        for motor, pins in enumerate(self._wiring):
            if pins == (pin_a, pin_b):
                return motor, 1
            if pins == (pin_b, pin_a):
                return motor, -1
        return -1, 0


@dataclass(slots=True)
class Counter:
    """A sketch's quadrature counter, four counts a line, on two pins of the board."""

    shafts: Shafts
    pin_a: int
    pin_b: int
    bits: int
    any_pin: bool = False
    """True if pin-change interrupts are used as well as external ones."""
    _zero: int = 0

    def __post_init__(self) -> None:
        """Begin at 0."""
        self.set(0)

    def total(self) -> int:
        """Return the count before it wraps."""
        motor, sign = self.shafts.motor(self.pin_a, self.pin_b)
        # Both channels need an interrupt: on 10 and 11, the third encoder, that is a pin-change one.
        if not sign or not (self.any_pin or {self.pin_a, self.pin_b} <= EXTERNAL_INTERRUPTS):
            return self._zero
        return self._zero + sign * self.shafts.edges[motor]

    @property
    def count(self) -> int:
        """The count, as wide as the sketch's variable."""
        return wrapped(self.total(), self.bits)

    def set(self, count: int) -> None:
        """Set the present count."""
        # An offset: the shaft's edges stay as they are, and so do other counters.
        self._zero += count - self.total()
