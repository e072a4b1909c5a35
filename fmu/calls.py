"""The three native calls of one communication step, prepared once: functions, arguments, arrays.

Nothing is converted or allocated between two steps; which FMU it is does not matter here.
"""

import ctypes
from collections.abc import Callable, Sequence
from typing import Any, Final, NamedTuple

OK_OR_WARNING: Final = 1
"""Highest status of FMI that lets a run go on."""

STATUS: Final = ("ok", "warning", "discard", "error", "fatal", "pending")


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


def prepare(
    library: ctypes.CDLL,
    instance: int,
    major: int,
    inputs: Sequence[int],
    outputs: Sequence[int],
    *,
    step: float,
) -> Calls:
    """Return the calls for these value references and this step in seconds, for FMI 2 or 3."""
    component = ctypes.c_void_p(instance)
    time, length = ctypes.c_double(0.0), ctypes.c_double(step)
    values_in, values_out = (ctypes.c_double * len(inputs))(), (ctypes.c_double * len(outputs))()
    references_in = (ctypes.c_uint32 * len(inputs))(*inputs)
    references_out = (ctypes.c_uint32 * len(outputs))(*outputs)
    count_in, count_out = ctypes.c_size_t(len(inputs)), ctypes.c_size_t(len(outputs))
    names = ("fmi2SetReal", "fmi2DoStep", "fmi2GetReal")
    write: tuple[Any, ...] = (component, references_in, count_in, values_in)
    read: tuple[Any, ...] = (component, references_out, count_out, values_out)
    forward: tuple[Any, ...] = (component, time, length, ctypes.c_int(1))
    if major > 2:  # noqa: PLR2004 - FMI 3.0 counts values, too, and tells more about a step
        names = ("fmi3SetFloat64", "fmi3DoStep", "fmi3GetFloat64")
        write, read = (*write, count_in), (*read, count_out)
        told = [ctypes.byref(ctypes.c_bool()) for _ in range(3)]
        no_rollback = ctypes.c_bool(True)  # noqa: FBT003 - C has no keywords
        forward = (component, time, length, no_rollback, *told, ctypes.byref(ctypes.c_double()))
    functions = [_function(library, name) for name in names]
    return Calls(functions[0], write, functions[1], forward, functions[2], read, time, values_in, values_out)


def _function(library: ctypes.CDLL, name: str) -> Callable[..., int]:
    # Looked up anew: FMPy's own function objects convert and check each argument.
    function = library[name]
    function.restype = ctypes.c_int
    return function
