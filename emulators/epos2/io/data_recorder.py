"""The data recorder 0x2010 to 0x201B: up to four values, tick by tick, around a trigger.

Source: EPOS2 Application Notes, April 2013, p. 176-185: memory of 512 words, divided among ring buffers, one
for each variable, one after the other; a number of 8 or 16 bits takes a word, one of 32 bits two. Where it is
silent: 0x201A counts samples, and is the same in each ring; the buffer is read whole, 1024 bytes, low byte
first; a start is refused with 0x06040043 for a variable that is not in the table here, and where there is
none; bit 0 of 0x2010 starts again each time it is written, bit 1 is the trigger by hand, 0 stops; it records
once; a movement is a velocity demand other than 0; any edge of any digital input counts.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.epos2.objects.axis_parameters import ACTUAL_VALUES, SENSOR_RESOLUTION
from emulators.servo.axis import ServoAxis
from emulators.servo.record import ServoRecord
from emulators.servo.recorder import ERROR
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at

CONTROL: Final = Address(0x2010)
CONFIGURATION: Final = Address(0x2011)
SAMPLING_PERIOD: Final = Address(0x2012)
PRECEDING_SAMPLES: Final = Address(0x2013)
VARIABLES: Final = Address(0x2014)
STATUS: Final = Address(0x2017)
MOST_SAMPLES: Final = Address(0x2018)
RECORDED_SAMPLES: Final = Address(0x2019)
START_OFFSET: Final = Address(0x201A)
BUFFER: Final = Address(0x201B)
MOST_VARIABLES: Final = 4
MEMORY_WORDS: Final = 512
WORD_BYTES: Final = 2
START: Final = 1 << 0
TRIGGER: Final = 1 << 1
RUNNING: Final = 1 << 0
TRIGGERED: Final = 1 << 1

_DEMANDED: Final = ("regulator", "position", "position_demand")
RECORDABLE: Final[Mapping[Address, tuple[str, ...]]] = MappingProxyType(
    {
        at.ENCODER_COUNTER: ("encoder", "slipped"),
        at.CURRENT_AVERAGED: ("current_average",),
        at.VELOCITY_AVERAGED: ("velocity_average",),
        at.CURRENT_DEMAND: ("current_demand_ma",),
        at.ANALOGUE_INPUT_1: ("analogue_1_mv",),
        at.ANALOGUE_INPUT_2: ("analogue_2_mv",),
        at.FOLLOWING_ERROR: _DEMANDED,
        od.POSITION_DEMAND: _DEMANDED,
        od.POSITION_ACTUAL: ("position",),
        od.VELOCITY_DEMAND: ("powered", "velocity_demand"),
        od.VELOCITY_ACTUAL: ("step",),
        od.CURRENT_ACTUAL: ("current_ma",),
        SENSOR_RESOLUTION: ("resolution",),
    }
)
"""Objects that can be recorded (assumed: the actual values), each with the axis' fields of its value."""

_VALUES: Final = dict(ACTUAL_VALUES)


class DataRecorder:
    """The recorder of one drive."""

    def __init__(self, store: ObjectStore, axis: ServoAxis) -> None:
        self._store = store
        self._axis = axis
        self._recorded: tuple[Address, ...] = ()
        """Objects in the memory; empty before the first start."""
        self._scale = (0, 0)
        """Resolution and fraction of the axis when it began."""
        store.on_write(CONTROL, self._command)
        store.on_read(STATUS, self._status)
        store.on_read(MOST_SAMPLES, lambda: self._capacity(self._chosen()))
        store.on_read(RECORDED_SAMPLES, lambda: self._axis.recorder.filled)
        store.on_read(START_OFFSET, self._start_offset)
        store.on_read_bytes(BUFFER, self._buffer)

    def reset(self) -> None:
        """Begin as after power-on: nothing recorded."""
        self._recorded = ()
        recorder = self._axis.recorder
        recorder.triggered = recorder.filled = recorder.next = 0

    def error(self) -> None:
        """Take an emergency as the trigger, where 0x2011 selects it."""
        if self._axis.recording and self._axis.recorder.triggers & ERROR:
            self._axis.recorder.trigger()

    # Objects

    def _command(self, word: int) -> None:
        # Both bits while it records are the trigger by hand: a restart would drop the samples before it.
        if word & START and not (word & TRIGGER and self._axis.recording):
            self._start()
        elif not word & START and not word & TRIGGER:
            self._axis.recording = 0
        if word & TRIGGER and self._axis.recording:
            self._axis.recorder.trigger()

    def _start(self) -> None:
        chosen, store = self._chosen(), self._store
        capacity = self._capacity(chosen)
        if not capacity:
            raise SdoAbort(AbortCode.PARAMETER_CLASH, CONTROL)
        recorder = self._axis.recorder
        # Objects are read at the start only: a change while it records counts for the next recording.
        recorder.triggers = store.get(CONFIGURATION)
        recorder.start(
            self._axis,
            tuple(field for address in chosen for field in RECORDABLE[address]),
            capacity=capacity,
            period=max(1, store.get(SAMPLING_PERIOD)),
            preceding=min(store.get(PRECEDING_SAMPLES), capacity),
        )
        self._recorded = chosen
        self._scale = (self._axis.resolution, self._axis.fraction)

    def _chosen(self) -> tuple[Address, ...]:
        get = self._store.get
        places = range(1, min(get(VARIABLES), MOST_VARIABLES) + 1)
        return tuple(Address(get(Address(0x2015, k)), get(Address(0x2016, k))) for k in places)

    def _capacity(self, chosen: tuple[Address, ...]) -> int:
        """Return how many samples of each variable have room; 0 where one of them cannot be recorded."""
        if not chosen or any(address not in RECORDABLE for address in chosen):
            return 0
        return MEMORY_WORDS // sum(map(self._words, chosen))

    def _status(self) -> int:
        running = RUNNING if self._axis.recording else 0
        return running | (TRIGGERED if self._axis.recorder.triggered else 0)

    def _start_offset(self) -> int:
        recorder = self._axis.recorder
        return (recorder.next - recorder.filled) % recorder.capacity if recorder.filled else 0

    def _buffer(self) -> bytes | None:
        """Return the whole memory, every number as its object would have shown it; None before the start."""
        if not self._recorded:
            return None
        # A sample holds the fields of all variables side by side, the memory one ring after the other.
        samples, begin, memory = self._axis.recorder.samples(), 0, bytearray()
        for address in self._recorded:
            fields = RECORDABLE[address]
            size = self._words(address) * WORD_BYTES
            for sample in samples:
                value = self._value(address, fields, sample[begin : begin + len(fields)])
                memory += (value & (1 << 8 * size) - 1).to_bytes(size, "little")
            begin += len(fields)
        return bytes(memory.ljust(MEMORY_WORDS * WORD_BYTES, b"\0"))

    def _value(self, address: Address, fields: tuple[str, ...], numbers: tuple[int, ...]) -> int:
        # The object's own formula, with the scale of the recording: the encoder may be set otherwise since.
        shadow = ServoRecord()
        shadow.resolution, shadow.fraction = self._scale
        for field, number in zip(fields, numbers, strict=True):
            setattr(shadow, field, number)
        return _VALUES[address](shadow)

    def _words(self, address: Address) -> int:
        return -(-self._store.objects[address].type.size // WORD_BYTES)
