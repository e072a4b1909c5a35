"""StandardFirmata 2.5, or ConfigurableFirmata with encoders: pins, and the raw I2C bus for the host.

Source: firmata/protocol; firmata/arduino, StandardFirmata.ino.

Where they are silent:
* an I2C request before I2C_CONFIG is passed over.
* a message beyond 64 bytes is served by its first 64, an I2C write beyond Wire's 32 by its first 32.
* digital inputs are looked at once a millisecond.
* the sampling interval is 10 ms at least.
* servos and tones are not emulated: a servo's pin takes the mode and nothing else.
* a report of all encoders is one message.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final, TypeAlias

from emulators.arduino_omni.mega.jobs import Call, Delay, OnBus, Say
from emulators.arduino_omni.mega.mega import CONVERSION, Mega
from emulators.arduino_omni.mega.pins import ANALOG, FIRST_ANALOG, INPUT, INPUT_PULLUP, OUTPUT, PINS, Counter
from emulators.arduino_omni.shield.i2c import Transfer, TransferResult, TransferSegment, read, write
from emulators.arduino_omni.sketches.firmata_pins import (
    FIRST_PIN,
    I2C_PINS,
    MODE_ANALOG,
    MODE_I2C,
    MODE_PULLUP,
    MODE_PWM,
    NO_CHANNEL,
    PORT,
    RESOLUTIONS,
    modes,
)
from firmware_bridge.families.motor_shield.wire import firmata as wire
from firmware_bridge.units import MICROSECOND, MILLISECOND, NEVER, Nanoseconds

VERSION: Final = b"\x02\x05"
STANDARD: Final = "StandardFirmata.ino"
CONFIGURABLE: Final = "ConfigurableFirmata.ino"
BLINKS: Final[Nanoseconds] = 2_100 * MILLISECOND
"""Time of the version on the lamp, before the sketch sends anything."""
SAMPLING: Final = 19
SHORTEST_SAMPLING: Final = 10
LOOKS: Final[Nanoseconds] = MILLISECOND
AFTER_WRITE: Final[Nanoseconds] = 70 * MICROSECOND
QUERIES: Final = 8
WIRE_BUFFER: Final = 32
ENCODERS: Final = 5


_Command: TypeAlias = Callable[[wire.Message], None]
_Exclusive: TypeAlias = Callable[[bytes], None]


@dataclass(frozen=True, slots=True)
class _Query:
    """A read that is made again and again, or once."""

    address: int
    register: int | None
    count: int
    restart: bool


class FirmataSketch:
    """One run of the sketch."""

    def __init__(self, mega: Mega, *, encoders: bool = False) -> None:
        """Begin as StandardFirmata, or with `encoders` as ConfigurableFirmata."""
        self._mega: Final = mega
        self._has_encoders: Final = encoders
        self._parser: Final = wire.Parser()
        self._started = False
        self._now: Nanoseconds = 0
        self._interval = SAMPLING
        self._sampled_at = 0
        self._looks_at: Nanoseconds = 0
        self._modes = bytearray(PINS)
        self._states: dict[int, int] = {}
        self._analog = 0
        self._ports: dict[int, int] = {}
        self._i2c = False
        self._delay = 0
        self._queries: list[_Query] = []
        self._pending: list[_Query] = []
        self._counters: dict[int, Counter] = {}
        self._reports_encoders = False
        self._commands: Final[dict[int, _Command]] = {
            wire.ANALOG: self._take_analog,
            wire.DIGITAL: self._write_port,
            wire.REPORT_ANALOG: self._take_report,
            wire.REPORT_DIGITAL: self._report_port,
            wire.PIN_MODE: self._take_mode,
            wire.PIN_VALUE: self._take_level,
            wire.VERSION: self._say_version,
            wire.RESET: self._reset,
        }
        self._exclusive: Final[dict[int, _Exclusive]] = {
            wire.FIRMWARE: self._say_firmware,
            wire.MAPPING_QUERY: self._say_mapping,
            wire.CAPABILITY_QUERY: self._say_capabilities,
            wire.PIN_STATE_QUERY: self._say_state,
            wire.EXTENDED_ANALOG: self._extended,
            wire.SAMPLING: self._set_sampling,
            wire.I2C_CONFIG: self._configure_i2c,
            wire.I2C_REQUEST: self._request_i2c,
        }
        if encoders:
            self._exclusive[wire.ENCODER] = self._encoder

    def setup(self) -> None:
        """Blink, and say who is there."""
        self._reset()
        self._mega.do(Delay(BLINKS))
        self._say_version()
        self._say_firmware()
        self._mega.do(Call(self._start))

    def _start(self, now: Nanoseconds) -> None:
        self._started = True
        self._sampled_at = self._mega.clock.millis(now)

    def due(self, now: Nanoseconds) -> Nanoseconds:
        """Return when inputs are looked at, or samples taken."""
        if not self._started:
            return NEVER
        samples = self._analog or self._queries or self._reports_encoders
        word = 1 << 32
        at = self._mega.clock.shows((self._sampled_at + self._interval + 1) % word, now) if samples else NEVER
        return min(at, max(now, self._looks_at)) if self._ports else at

    def loop(self, now: Nanoseconds) -> None:
        """Look at the inputs, obey one message, take samples."""
        self._now = now
        if self._ports and now >= self._looks_at:
            self._looks_at = now + LOOKS
            self._look()
        while (byte := self._mega.serial.read()) >= 0:
            message = self._parser.take(byte)
            if message is not None:
                self._obey(message)
                return
        millis = self._mega.clock.millis(now)
        if (millis - self._sampled_at) % (1 << 32) > self._interval:
            self._sampled_at = millis
            self._sample()

    def _obey(self, message: wire.Message) -> None:
        if message.exclusive:
            handler = self._exclusive.get(message.code)
            if handler is not None:
                handler(message.data)
        else:
            self._commands[message.code](message)

    def _say(self, message: wire.Message) -> None:
        self._mega.do(Say(wire.encode(message)))

    def _say_exclusive(self, code: int, data: bytes) -> None:
        self._say(wire.Message(code, data, exclusive=True))

    def _complain(self, text: str) -> None:
        self._say_exclusive(wire.STRING, wire.pairs(text.encode()))

    def _say_version(self, _message: wire.Message | None = None) -> None:
        self._say(wire.Message(wire.VERSION, VERSION))

    def _say_firmware(self, _data: bytes = b"") -> None:
        name = CONFIGURABLE if self._has_encoders else STANDARD
        self._say_exclusive(wire.FIRMWARE, VERSION + wire.pairs(name.encode()))

    def _say_mapping(self, _data: bytes = b"") -> None:
        channels = (pin - FIRST_ANALOG if pin >= FIRST_ANALOG else NO_CHANNEL for pin in range(PINS))
        self._say_exclusive(wire.MAPPING, bytes(channels))

    def _say_capabilities(self, _data: bytes = b"") -> None:
        answer = bytearray()
        for pin in range(PINS):
            for mode in modes(pin, encoders=self._has_encoders):
                answer += bytes((mode, RESOLUTIONS[mode]))
            answer.append(NO_CHANNEL)
        self._say_exclusive(wire.CAPABILITY, bytes(answer))

    def _say_state(self, data: bytes) -> None:
        if not data:
            return
        pin = data[0]
        if pin >= PINS:
            self._say_exclusive(wire.PIN_STATE, bytes((pin & wire.SEVEN,)))
            return
        state = self._states.get(pin, 0)
        rest = bytes((state >> 7 & wire.SEVEN,)) if state >> 7 else b""
        self._say_exclusive(wire.PIN_STATE, bytes((pin, self._modes[pin], state & wire.SEVEN)) + rest)

    # Pins

    def _take_analog(self, message: wire.Message) -> None:
        self._write_analog(message.channel, wire.unpaired(message.data)[0])

    def _take_report(self, message: wire.Message) -> None:
        self._report_analog(message.channel, message.data[0])

    def _take_mode(self, message: wire.Message) -> None:
        self._set_mode(*message.data)

    def _take_level(self, message: wire.Message) -> None:
        self._write_pin(*message.data)

    def _reset(self, _message: wire.Message | None = None) -> None:
        started, self._started = self._started, False
        self._analog = 0
        self._ports.clear()
        self._queries.clear()
        self._counters.clear()
        self._i2c = self._reports_encoders = False
        for pin in range(FIRST_PIN, PINS):
            self._set_mode(pin, MODE_ANALOG if pin >= FIRST_ANALOG else OUTPUT)
        self._analog = 0
        self._started = started

    def _set_mode(self, pin: int, mode: int) -> None:
        if mode not in modes(pin, encoders=self._has_encoders):
            return
        if pin >= FIRST_ANALOG:
            self._report_analog(pin - FIRST_ANALOG, int(mode == MODE_ANALOG))
        self._modes[pin] = mode
        self._states[pin] = int(mode == MODE_PULLUP)
        if mode == MODE_PULLUP:
            self._mega.pins.configure(pin, INPUT_PULLUP)
        elif mode in {OUTPUT, MODE_PWM}:
            self._mega.pins.write(pin, 0)
            self._mega.pins.configure(pin, OUTPUT)
        else:
            self._mega.pins.configure(pin, INPUT)

    def _write_analog(self, pin: int, value: int) -> None:
        if pin < PINS and self._modes[pin] == MODE_PWM:
            self._mega.pins.write_analog(pin, value & 0xFF)
            self._states[pin] = value

    def _extended(self, data: bytes) -> None:
        if len(data) > 1:
            value = sum((byte & wire.SEVEN) << 7 * place for place, byte in enumerate(data[1:4]))
            self._write_analog(data[0], value)

    def _write_pin(self, pin: int, level: int) -> None:
        if pin < PINS and self._modes[pin] == OUTPUT and pin >= FIRST_PIN:
            self._mega.pins.write(pin, level)
            self._states[pin] = int(level != 0)

    def _write_port(self, message: wire.Message) -> None:
        levels = message.data[0] | message.data[1] << 7
        for place in range(PORT):
            pin = message.channel * PORT + place
            if pin < PINS and self._modes[pin] in {INPUT, OUTPUT} and self._mega.pins.modes[pin] == OUTPUT:
                self._write_pin(pin, levels >> place & 1)

    def _report_analog(self, channel: int, wanted: int) -> None:
        bit = 1 << channel
        self._analog = self._analog | bit if wanted else self._analog & ~bit
        if wanted and self._started and channel < ANALOG:
            self._say_analog(channel)

    def _say_analog(self, channel: int) -> None:
        self._mega.do(Delay(CONVERSION))
        raw = self._mega.pins.read_analog(channel)
        self._say(wire.Message(wire.ANALOG, wire.pairs((raw,)), channel))

    def _report_port(self, message: wire.Message) -> None:
        port = message.channel
        if not message.data[0]:
            self._ports.pop(port, None)
        elif port * PORT < PINS:
            self._ports[port] = self._levels(port)
            self._say_port(port)

    def _levels(self, port: int) -> int:
        pins = range(port * PORT, min((port + 1) * PORT, PINS))
        inputs = (pin for pin in pins if pin >= FIRST_PIN and self._modes[pin] in {INPUT, MODE_PULLUP})
        return sum(self._mega.pins.read(pin) << pin % PORT for pin in inputs)

    def _say_port(self, port: int) -> None:
        self._say(wire.Message(wire.DIGITAL, wire.pairs((self._ports[port],)), port))

    def _look(self) -> None:
        for port, before in self._ports.items():
            levels = self._levels(port)
            if levels != before:
                self._ports[port] = levels
                self._say_port(port)

    def _set_sampling(self, data: bytes) -> None:
        if len(data) > 1:
            self._interval = max(wire.unpaired(data)[0], SHORTEST_SAMPLING)

    def _sample(self) -> None:
        for channel in range(ANALOG):
            if self._analog >> channel & 1:
                self._say_analog(channel)
        for query in self._queries:
            self._read(query)
        if self._reports_encoders:
            self._say_encoders(sorted(self._counters))

    # I2C

    def _configure_i2c(self, data: bytes) -> None:
        delay = wire.unpaired(data)[0] if data else 0
        self._delay = delay or self._delay
        self._i2c = True
        for pin in I2C_PINS:
            self._modes[pin] = MODE_I2C

    def _request_i2c(self, data: bytes) -> None:
        if not self._i2c or len(data) < len(("address", "mode")):
            return
        address, mode = data[0] & wire.SEVEN, data[1]
        if mode & wire.I2C_TEN_BITS:
            self._complain("10-bit addressing not supported")
            return
        values = wire.unpaired(data[2:])
        wanted = mode & wire.I2C_STOP
        if wanted == wire.I2C_WRITE:
            written = bytes(it & 0xFF for it in values[:WIRE_BUFFER])
            self._mega.do(OnBus(write(address, written)), Delay(AFTER_WRITE))
        elif wanted == wire.I2C_STOP:
            self._forget(address)
        elif values:
            register = values[0] & 0xFF if len(values) > 1 else None
            query = _Query(address, register, values[min(1, len(values) - 1)], bool(mode & wire.I2C_RESTART))
            if wanted == wire.I2C_READ:
                self._read(query)
            elif len(self._queries) < QUERIES:
                self._queries.append(query)
            else:
                self._complain("too many queries")

    def _forget(self, address: int) -> None:
        for place, query in enumerate(self._queries):
            if query.address == address:
                del self._queries[place]
                return

    def _read(self, query: _Query) -> None:
        """Request bytes; the answer is made when they are there."""
        count = min(query.count, WIRE_BUFFER)
        if not count:
            return
        self._pending.append(query)
        if query.register is None:
            self._mega.do(OnBus(read(query.address, count), self._reply))
            return
        register = bytes((query.register,))
        if query.restart and not self._delay:
            segments = (
                TransferSegment(query.address, register),
                TransferSegment(query.address, to_read=count),
            )
            self._mega.do(OnBus(Transfer(segments), self._reply))
            return
        self._mega.do(OnBus(write(query.address, register)), Delay(self._delay * MICROSECOND))
        self._mega.do(OnBus(read(query.address, count), self._reply))

    def _reply(self, result: TransferResult, _now: Nanoseconds) -> None:
        query = self._pending.pop(0)
        if len(result.read) < query.count:
            self._complain("I2C: Too few bytes received")
        values = (query.address, query.register or 0, *result.read)
        self._say_exclusive(wire.I2C_REPLY, wire.pairs(values))

    # Encoders

    def _encoder(self, data: bytes) -> None:
        what = data[0] if data else None
        number = data[1] if len(data) > 1 else ENCODERS
        if what == 0 and len(data) > 3 and number < ENCODERS:  # noqa: PLR2004 - two pins follow
            self._counters[number] = Counter(self._mega.shafts, data[2], data[3], 32)
        elif what == 1 and number in self._counters:
            self._say_encoders([number])
        elif what == 2 and self._counters:  # noqa: PLR2004 - a number of the protocol's
            self._say_encoders(sorted(self._counters))
        elif what == 3 and number in self._counters:  # noqa: PLR2004 - as above
            self._counters[number].set(0)
        elif what == 4 and len(data) > 1:  # noqa: PLR2004 - as above
            self._reports_encoders = bool(number)
        elif what == 5:  # noqa: PLR2004 - as above
            self._counters.pop(number, None)

    def _say_encoders(self, numbers: list[int]) -> None:
        answer = bytearray()
        for number in numbers:
            count = self._counters[number].count
            answer.append((count < 0) << 6 | number)
            answer += bytes(abs(count) >> 7 * place & wire.SEVEN for place in range(4))
        self._say_exclusive(wire.ENCODER, bytes(answer))
