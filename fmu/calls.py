"""The three native calls of one communication step, prepared once: functions, arguments, arrays, addresses.

Nothing is converted or allocated between two steps; which FMU it is does not matter here.
"""

import ctypes
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any, ClassVar, Final, NamedTuple

OK_OR_WARNING: Final = 1
"""Highest status of FMI that lets a run go on."""

SECOND_NS: Final = 1e9

STATUS: Final = (
    *("ok", "warning", "discard", "error", "fatal", "pending"),
    *("it wants the simulation to end", "it stopped before the step was over"),
)
"""FMI's statuses in words, and then the results of a step in FMI 3.0 beside its status (section 4.2.1)."""
WANTS_TO_END: Final = 6
STOPPED_SHORT: Final = 7


class PlantRecord(ctypes.Structure):
    """The same calls as bare addresses, for a master in C; value references are 32 bits, values doubles.

    All functions are null once the plant is closed. `steps_done` is the plant's own count of its steps.
    """

    _fields_: ClassVar = [
        ("fmi", ctypes.c_int64),
        ("component", ctypes.c_void_p),
        ("write", ctypes.c_void_p),
        ("forward", ctypes.c_void_p),
        ("read", ctypes.c_void_p),
        ("input_references", ctypes.c_void_p),
        ("input_count", ctypes.c_int64),
        ("inputs", ctypes.c_void_p),
        ("output_references", ctypes.c_void_p),
        ("output_count", ctypes.c_int64),
        ("outputs", ctypes.c_void_p),
        ("step_ns", ctypes.c_int64),
        ("steps_done", ctypes.c_int64),
        # Which of the inputs and outputs the plant has with the other sign, from 0.
        ("mirrored_inputs", ctypes.c_void_p),
        ("mirrored_input_count", ctypes.c_int64),
        ("mirrored_outputs", ctypes.c_void_p),
        ("mirrored_output_count", ctypes.c_int64),
    ]


class Mirrored(NamedTuple):
    """Indexes of the inputs and outputs that the plant has with the other sign, from 0."""

    inputs: Sequence[int] = ()
    outputs: Sequence[int] = ()


class Calls(NamedTuple):
    """Functions of the FMU with the arguments of every step; `time` is set before each."""

    write: Callable[..., int]
    write_arguments: tuple[Any, ...]
    step: Callable[..., int]
    step_arguments: tuple[Any, ...]
    read: Callable[..., int]
    read_arguments: tuple[Any, ...]
    time: ctypes.c_double
    inputs: "ctypes.Array[ctypes.c_double]"
    outputs: "ctypes.Array[ctypes.c_double]"
    record: PlantRecord
    held: tuple[Any, ...]
    """Objects whose addresses are in the record, beside the above."""


class Look(NamedTuple):
    """What reads some variables between two steps."""

    read: Callable[..., int]
    arguments: tuple[Any, ...]
    values: "ctypes.Array[ctypes.c_double]"


NOT_MIRRORED: Final = Mirrored()


def prepare(
    library: ctypes.CDLL,
    instance: int,
    major: int,
    inputs: Sequence[int],
    outputs: Sequence[int],
    *,
    step: int,
    mirrored: Mirrored = NOT_MIRRORED,
) -> Calls:
    """Return the calls for these value references and this step in ns, for FMI 2 or 3."""
    component = ctypes.c_void_p(instance)
    time, length = ctypes.c_double(0.0), ctypes.c_double(step / SECOND_NS)
    values_in, values_out = (ctypes.c_double * len(inputs))(), (ctypes.c_double * len(outputs))()
    references_in = (ctypes.c_uint32 * len(inputs))(*inputs)
    references_out = (ctypes.c_uint32 * len(outputs))(*outputs)
    count_in, count_out = ctypes.c_size_t(len(inputs)), ctypes.c_size_t(len(outputs))
    names = ("fmi2SetReal", "fmi2DoStep", "fmi2GetReal")
    write: tuple[Any, ...] = (component, references_in, count_in, values_in)
    read: tuple[Any, ...] = (component, references_out, count_out, values_out)
    # The fourth: whether no state from before this step will ever be set again. Time may be rewound.
    forward: tuple[Any, ...] = (component, time, length, ctypes.c_int(0))
    if major > 2:  # noqa: PLR2004 - FMI 3.0 counts values, too, and reports more about a step
        names = ("fmi3SetFloat64", "fmi3DoStep", "fmi3GetFloat64")
        write, read = (*write, count_in), (*read, count_out)
        # The flags of fmi3DoStep live as long as the calls: their addresses are among the arguments.
        event, over, early = (ctypes.c_bool() for _ in range(3))
        flags = [ctypes.byref(flag) for flag in (event, over, early)]
        no_rollback = ctypes.c_bool(False)  # noqa: FBT003 - C has no keywords
        forward = (component, time, length, no_rollback, *flags, ctypes.byref(ctypes.c_double()))
    functions = [_function(library, name) for name in names]
    step_call = functions[1] if major < 3 else partial(_step_3, functions[1], over, early)  # noqa: PLR2004 - as above
    turned_in, turned_out = (
        (ctypes.c_int64 * len(places))(*places) for places in (mirrored.inputs, mirrored.outputs)
    )
    addresses = [ctypes.cast(function, ctypes.c_void_p) for function in functions]
    record = PlantRecord(
        fmi=major,
        component=instance,
        write=addresses[0],
        forward=addresses[1],
        read=addresses[2],
        input_references=ctypes.addressof(references_in),
        input_count=len(inputs),
        inputs=ctypes.addressof(values_in),
        output_references=ctypes.addressof(references_out),
        output_count=len(outputs),
        outputs=ctypes.addressof(values_out),
        step_ns=step,
        mirrored_inputs=ctypes.addressof(turned_in),
        mirrored_input_count=len(turned_in),
        mirrored_outputs=ctypes.addressof(turned_out),
        mirrored_output_count=len(turned_out),
    )
    write_call: Callable[..., int] = functions[0]
    read_call: Callable[..., int] = functions[2]
    if mirrored.inputs:
        write_call = partial(_write_mirrored, functions[0], values_in, mirrored.inputs)
    if mirrored.outputs:
        read_call = partial(_read_mirrored, functions[2], values_out, mirrored.outputs)
    return Calls(
        write_call,
        write,
        step_call,
        forward,
        read_call,
        read,
        time,
        values_in,
        values_out,
        record,
        (turned_in, turned_out),
    )


def look(library: ctypes.CDLL, instance: int, major: int, references: Sequence[int]) -> Look:
    """Return the call that reads these value references between two steps, for FMI 2 or 3."""
    values, count = (ctypes.c_double * len(references))(), ctypes.c_size_t(len(references))
    named = (ctypes.c_uint32 * len(references))(*references)
    arguments: tuple[Any, ...] = (ctypes.c_void_p(instance), named, count, values)
    if major > 2:  # noqa: PLR2004 - FMI 3.0 counts values, too
        return Look(_function(library, "fmi3GetFloat64"), (*arguments, count), values)
    return Look(_function(library, "fmi2GetReal"), arguments, values)


def _write_mirrored(
    write: Callable[..., int], values: "ctypes.Array[ctypes.c_double]", places: Sequence[int], *arguments: Any
) -> int:
    """Write the inputs, these with the other sign; the master's own values stay as it has written them."""
    _turn_over(values, places)
    status = write(*arguments)
    # Turned back: a value that is not written again is sent with the next step, too.
    _turn_over(values, places)
    return status


def _read_mirrored(
    read: Callable[..., int], values: "ctypes.Array[ctypes.c_double]", places: Sequence[int], *arguments: Any
) -> int:
    status = read(*arguments)
    # After a failure the values are those of the step before, already with the master's sign.
    if status <= OK_OR_WARNING:
        _turn_over(values, places)
    return status


def _turn_over(values: "ctypes.Array[ctypes.c_double]", places: Sequence[int]) -> None:
    for place in places:
        values[place] = -values[place]


def _step_3(step: Callable[..., int], over: ctypes.c_bool, early: ctypes.c_bool, *arguments: Any) -> int:
    status = step(*arguments)
    if status > OK_OR_WARNING:
        return status
    # FMI 3.0 reports both with status OK: neither may pass for a whole step.
    return WANTS_TO_END if over.value else STOPPED_SHORT if early.value else status


def _function(library: ctypes.CDLL, name: str) -> Any:
    # Looked up again: FMPy's own function objects convert and check each argument.
    function = library[name]
    function.restype = ctypes.c_int
    return function
