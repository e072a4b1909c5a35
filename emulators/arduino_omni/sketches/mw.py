"""The sketch of MATLAB's Arduino package: MWProtocol, motor shield, rotary encoders; no loop on the board.

Source: `families.motor_shield.wire.mw`. A damaged frame and an unknown command have no answer. Each
byte of a frame has a second to come; what waits when an answer has gone is thrown away.

Where it is silent:
* the banner has no line end.
* a frame shorter than its command needs, or larger than 800 bytes, is not answered.
* a motor, a shield or an encoder that was not made takes nothing, and is answered all the same.
* a count's overflow is the number of times that 32 bits were not enough.
* 5000 bytes are free; version 17.1, as in the worked frames.
* steppers, and the libraries I2C and Servo, are named and stay silent.
"""

from collections.abc import Callable, Mapping
from struct import Struct
from typing import Any, Final, TypeAlias

from emulators.arduino_omni.mega import motor_library as library
from emulators.arduino_omni.mega.arithmetic import int16, wrapped
from emulators.arduino_omni.mega.jobs import Call, Delay, OnBus, Say
from emulators.arduino_omni.mega.mega import CONVERSION, Mega
from emulators.arduino_omni.mega.pins import FIRST_ANALOG, LED, OUTPUT, Counter
from emulators.arduino_omni.shield.i2c import write
from emulators.arduino_omni.shield.motor_shield import Port
from firmware_bridge.families.motor_shield.wire import mw
from firmware_bridge.families.motor_shield.wire import mw_messages as messages
from firmware_bridge.units import MILLISECOND, NEVER, SECOND, Nanoseconds

VERSION: Final = (17, 1)
BOARD: Final = b"Mega2560"
FREE_RAM: Final = 5_000
READ_TIMEOUT: Final[Nanoseconds] = SECOND
"""Stream's default, for each byte."""
SPEED_TIME: Final[Nanoseconds] = 20 * MILLISECOND
STOCK_ENCODERS: Final = 2
_SPEED: Final = Struct("<bh")
_Handler: TypeAlias = Callable[[Any], None]


class MwSketch:
    """One run of the sketch. `encoders` is how many it counts: the stock library two."""

    def __init__(
        self, mega: Mega, libraries: tuple[str, ...] = mw.LIBRARIES, encoders: int = STOCK_ENCODERS
    ) -> None:
        self._mega: Final = mega
        self._libraries: Final = libraries
        self._encoders: Final = encoders
        self._requests: Final = mw.RequestReader()
        self._late_at: Nanoseconds = NEVER
        self._code = 0
        self._now: Nanoseconds = 0
        self._shields: dict[int, int] = {}
        self._motors: dict[tuple[int, int], Port] = {}
        self._counters: dict[int, Counter] = {}
        self._counts_before: list[tuple[int, int]] = []
        self._handlers: Final[Mapping[type[Any], _Handler]] = {
            messages.GetServerInfo: self._info,
            messages.ResetPins: self._reset_pins,
            messages.GetFreeRam: self._free_ram,
            messages.WriteDigital: self._write_pin,
            messages.ReadDigital: self._read_pin,
            messages.ConfigureDigital: self._configure_pin,
            messages.WriteDuty: self._write_pwm,
            messages.WriteVoltage: self._write_pwm,
            messages.PlayTone: self._done,
            messages.ReadVoltage: self._read_voltage,
            messages.CreateShield: self._create_shield,
            messages.DeleteShield: self._delete_shield,
            messages.CreateMotor: self._create_motor,
            messages.StartMotor: self._drive,
            messages.SetMotorSpeed: self._drive,
            messages.StopMotor: self._stop,
            messages.AttachEncoder: self._attach,
            messages.DetachEncoder: self._detach,
            messages.SetDelay: self._done,
            messages.ReadCount: self._read_count,
            messages.ReadSpeed: self._read_speed,
            messages.WriteCount: self._write_count,
        }

    def setup(self) -> None:
        """Send the banner."""
        self._mega.do(Say(mw.BANNER))

    def due(self, now: Nanoseconds) -> Nanoseconds:
        """Return when the next byte of a frame is late."""
        del now
        return self._late_at

    def loop(self, now: Nanoseconds) -> None:
        """Read up to the end of a frame, and obey it."""
        self._now = now
        # readBytes() waits 1 s for each byte: a frame that the host has cut off is forgotten then.
        if self._late_at <= now:
            self._requests.forget()
            self._late_at = NEVER
        while (byte := self._mega.serial.read()) >= 0:
            frame = self._requests.take(byte)
            self._late_at = now + READ_TIMEOUT if self._requests.waits else NEVER
            if frame is not None and self._obey(frame):
                return

    def _obey(self, frame: mw.RequestFrame) -> bool:
        """Obey a request, where it is known; return whether there is something to do now."""
        row = mw.row_of_frame(frame, self._libraries)
        request = None if row is None or row.request is None else row.request.decode(frame.data)
        if request is None:
            return False
        self._code = frame.code
        self._handlers[type(request)](request)
        return True

    def _answer(self, data: bytes = b"") -> None:
        # The sketch flushes its input behind each answer: a host that sends ahead loses frames.
        self._mega.do(Say(mw.encode_answer(self._code, data)), Call(self._flush))

    def _flush(self, _now: Nanoseconds) -> None:
        self._mega.serial.flush_input()

    def _done(self, _request: object) -> None:
        self._answer()

    # The board

    def _info(self, request: messages.GetServerInfo) -> None:
        names = tuple(name.encode() for name in self._libraries)
        # GET_SERVER_INFO lights pin 13, as the original does.
        self._mega.pins.configure(LED, OUTPUT)
        self._mega.pins.write(LED, 1)
        self._answer(mw.row_of(request).answer.encode(messages.ServerInfo(*VERSION, BOARD, 0, names)))

    def _reset_pins(self, _request: messages.ResetPins) -> None:
        self._mega.pins.reset()
        self._answer()

    def _free_ram(self, request: messages.GetFreeRam) -> None:
        self._answer(mw.row_of(request).answer.encode(messages.FreeRam(FREE_RAM)))

    def _write_pin(self, request: messages.WriteDigital) -> None:
        self._mega.pins.write(_pin(request.analog, request.pin), request.level)
        self._answer()

    def _read_pin(self, request: messages.ReadDigital) -> None:
        self._answer(bytes((self._mega.pins.read(_pin(request.analog, request.pin)),)))

    def _configure_pin(self, request: messages.ConfigureDigital) -> None:
        self._mega.pins.configure(_pin(request.analog, request.pin), request.mode)
        self._answer()

    def _write_pwm(self, request: messages.WriteDuty | messages.WriteVoltage) -> None:
        self._mega.pins.write_analog(request.pin, request.value)
        self._answer()

    def _read_voltage(self, request: messages.ReadVoltage) -> None:
        self._mega.do(Delay(CONVERSION))
        raw = self._mega.pins.read_analog(request.pin)
        self._answer(mw.row_of(request).answer.encode(messages.Voltage(raw)))

    # The shield

    def _create_shield(self, request: messages.CreateShield) -> None:
        self._shields[request.shield] = request.address
        self._mega.do_all(library.begin(request.address, request.frequency))
        self._answer()

    def _delete_shield(self, request: messages.DeleteShield) -> None:
        self._shields.pop(request.shield, None)
        self._answer()

    def _create_motor(self, request: messages.CreateMotor) -> None:
        # MATLAB counts motors from 0, getMotor() from 1.
        port = library.motor(request.motor + 1)
        if port is not None and request.shield in self._shields:
            self._motors[request.shield, request.motor] = port
        self._answer()

    def _made(self, shield: int, motor: int) -> tuple[int, Port] | None:
        port = self._motors.get((shield, motor))
        address = self._shields.get(shield)
        return None if port is None or address is None else (address, port)

    def _drive(self, request: messages.StartMotor | messages.SetMotorSpeed) -> None:
        made = self._made(request.shield, request.motor)
        if made is not None:
            self._mega.do_all(library.drive(*made, request.speed, request.direction))
        self._answer()

    def _stop(self, request: messages.StopMotor) -> None:
        made = self._made(request.shield, request.motor)
        if made is not None:
            address, port = made
            self._mega.do_all(
                OnBus(write(address, data)) for data in library.run(port, library.RunArgument.RELEASE)
            )
        self._answer()

    # Encoders

    def _attach(self, request: messages.AttachEncoder) -> None:
        if request.encoder < self._encoders:
            stock = self._encoders <= STOCK_ENCODERS
            # The stock library counts two encoders, by external interrupts only.
            counter = Counter(self._mega.shafts, request.pin_a, request.pin_b, 64, any_pin=not stock)
            self._counters[request.encoder] = counter
        self._answer()

    def _detach(self, request: messages.DetachEncoder) -> None:
        self._counters.pop(request.encoder, None)
        self._answer()

    def _total(self, encoder: int) -> int:
        counter = self._counters.get(encoder)
        return 0 if counter is None else counter.count

    def _read_count(self, request: messages.ReadCount) -> None:
        total = self._total(request.encoder)
        count = wrapped(total, 32)
        # What is beyond the INT32 of the count, in an INT8.
        overflow = wrapped((total - count) >> 32, 8)
        answer = messages.Count(count, self._mega.clock.millis(self._now), overflow)
        if request.reset and request.encoder in self._counters:
            # Behind the reading: the answer has the count up to here.
            self._counters[request.encoder].set(0)
        self._answer(mw.row_of(request).answer.encode(answer))

    def _read_speed(self, request: messages.ReadSpeed) -> None:
        self._counts_before = [(it, self._total(it)) for it in request.encoders]
        # Counted over 20 ms, in which the sketch reads no byte.
        self._mega.do(Delay(SPEED_TIME), Call(self._speeds_now))

    def _speeds_now(self, _now: Nanoseconds) -> None:
        pairs = [(self._total(it) - before) for it, before in self._counts_before]
        # For each encoder an overflow flag, and the difference as INT16, low byte first.
        self._answer(b"".join(_SPEED.pack(int(it != int16(it)), int16(it)) for it in pairs))

    def _write_count(self, request: messages.WriteCount) -> None:
        if request.encoder in self._counters:
            self._counters[request.encoder].set(request.count)
        self._answer()


def _pin(analog: int, pin: int) -> int:
    return FIRST_ANALOG + pin if analog else pin
