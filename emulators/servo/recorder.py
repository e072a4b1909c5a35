"""Records fields of an axis tick by tick into a ring, with samples from before a trigger.

Whole numbers only; the kernel in C works on the same record. Not known here: objects and their units: what
is kept are the axis' own numbers.
"""

import ctypes
from typing import ClassVar, Final

from emulators.servo.record import FIELDS, ServoRecord

MOVEMENT_START: Final = 1 << 0
"""The velocity demand has left 0."""
ERROR: Final = 1 << 1
"""Trigger by the module that handles errors: see `Recorder.trigger`."""
INPUT_EDGE: Final = 1 << 2
"""A level at an input pin has changed."""
MOVEMENT_END: Final = 1 << 3
"""The velocity demand has come back to 0."""

MOST_SOURCES: Final = 12
"""Four variables, each made from up to three fields."""
MOST_NUMBERS: Final = 512 * 3
"""The memory's 512 words, each made from up to three fields."""


class Recorder(ctypes.Structure):
    """One recorder. `left`: ticks to the next sample; `remaining`: samples to the end once triggered."""

    _fields_: ClassVar = [
        ("sources", ctypes.c_void_p),
        ("memory", ctypes.c_void_p),
        ("width", ctypes.c_int64),
        ("capacity", ctypes.c_int64),
        ("period", ctypes.c_int64),
        ("preceding", ctypes.c_int64),
        ("triggers", ctypes.c_int64),
        ("left", ctypes.c_int64),
        ("triggered", ctypes.c_int64),
        ("remaining", ctypes.c_int64),
        ("next", ctypes.c_int64),
        ("filled", ctypes.c_int64),
        ("moving", ctypes.c_int64),
        ("pins", ctypes.c_int64),
    ]

    def __init__(self) -> None:
        """Begin without memory: it is taken when something is recorded for the first time."""
        super().__init__()
        self.source_numbers = (ctypes.c_int64 * 0)()
        self.numbers = (ctypes.c_int64 * 0)()

    def start(
        self, axis: ServoRecord, fields: tuple[str, ...], *, capacity: int, period: int, preceding: int
    ) -> None:
        """Record these fields again every `period` ticks; `preceding` samples are from before the trigger."""
        if not self.numbers:
            self.source_numbers = (ctypes.c_int64 * MOST_SOURCES)()
            self.numbers = (ctypes.c_int64 * MOST_NUMBERS)()
            self.sources = ctypes.addressof(self.source_numbers)
            self.memory = ctypes.addressof(self.numbers)
        for place, field in enumerate(fields):
            self.source_numbers[place] = FIELDS.index(field)
        self.width, self.capacity = len(fields), capacity
        self.period, self.preceding = period, preceding
        self.left = self.triggered = self.remaining = self.next = self.filled = 0
        self.moving, self.pins = is_moving(axis), axis.pins
        axis.recording = 1

    def trigger(self) -> None:
        """Let the recording come to its end: what happens from now on, after the preceding samples."""
        if not self.triggered:
            self.triggered = 1
            # At least the sample of the trigger itself.
            self.remaining = max(1, self.capacity - self.preceding)

    def samples(self) -> list[tuple[int, ...]]:
        """Return the ring as it lies in memory, a tuple for each sample, empty places as zeros."""
        width = self.width
        return [tuple(self.numbers[at * width : (at + 1) * width]) for at in range(self.capacity)]


def is_moving(axis: ServoRecord) -> int:
    """Return 1 while a movement is demanded, else 0."""
    return 1 if axis.powered and axis.velocity_demand else 0


def record(axis: ServoRecord, recorder: Recorder) -> None:
    """Run one tick of an axis that is recorded: look for the trigger, take the sample that is due."""
    moving, pins = is_moving(axis), axis.pins
    if not recorder.triggered:
        happened = INPUT_EDGE if pins != recorder.pins else 0
        if moving != recorder.moving:
            happened |= MOVEMENT_START if moving else MOVEMENT_END
        if happened & recorder.triggers:
            recorder.trigger()
    recorder.moving, recorder.pins = moving, pins
    if recorder.left:
        recorder.left -= 1
    else:
        recorder.left = recorder.period - 1
        _sample(axis, recorder)


def _sample(axis: ServoRecord, recorder: Recorder) -> None:
    width = recorder.width
    begin = recorder.next * width
    for place in range(width):
        recorder.numbers[begin + place] = getattr(axis, FIELDS[recorder.source_numbers[place]])
    recorder.next = (recorder.next + 1) % recorder.capacity
    recorder.filled = min(recorder.filled + 1, recorder.capacity)
    if recorder.triggered:
        recorder.remaining -= 1
        if not recorder.remaining:
            axis.recording = 0
