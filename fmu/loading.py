"""Unzip, check, load and instantiate an FMU with FMPy, and undo all of it, once.

Variables are not known here: only whether this machine can run the file as a slave.
"""

import contextlib
import ctypes
import shutil
import tempfile
import weakref
from collections import deque
from collections.abc import Callable
from functools import lru_cache
from itertools import count
from pathlib import Path
from typing import Any, Final
from zipfile import BadZipFile, ZipFile

import fmpy
from fmpy import fmi2, fmi3
from fmpy.logging import addLoggerProxy
from fmpy.model_description import read_model_description

from fmu.calls import OK_OR_WARNING
from fmu.errors import PlantError
from fmu.states import Vault


def described(path: Path) -> Any:
    """Return FMPy's model description after all of its checks."""
    must_be_file(path)
    try:
        with ZipFile(path) as archive:
            members = tuple((member.filename, member.CRC) for member in archive.infolist())
    except (BadZipFile, OSError) as error:
        raise PlantError(f"{path}: not an FMU: {error}") from error
    return _described(path, members)


def must_be_file(path: Path) -> None:
    """PlantError where this path leads to no file."""
    if not path.is_file():
        wrong = "it is a folder, not an FMU" if path.is_dir() else "there is no such file"
        raise PlantError(f"{path}: {wrong}; give the path of an FMU")


@lru_cache(maxsize=16)
def _described(path: Path, members: tuple[tuple[str, int], ...]) -> Any:
    """Describe the FMU that holds these members, by name and checksum: each is read and checked once."""
    names = [name for name, _ in members]
    if "modelDescription.xml" not in names:
        raise PlantError(f"{path}: not an FMU: it holds no modelDescription.xml")
    try:
        description = read_model_description(str(path))
    except Exception as error:
        raise PlantError(f"{path}: its modelDescription.xml is not valid: {error}") from error
    version = description.fmiVersion
    if not version.startswith(("2.0", "3.0")):
        raise PlantError(f"{path}: FMI {version} is not supported: 2.0 or 3.0")
    if description.coSimulation is None:
        raise PlantError(f"{path}: the FMU offers no co-simulation; export it with its solver")
    # The folders are named otherwise in both versions: linux64 in FMI 2.0, x86_64-linux in FMI 3.0.
    folder = f"binaries/{fmpy.platform if version.startswith('2') else fmpy.platform_tuple}/"
    if not any(name.startswith(folder) for name in names):
        held = sorted({name.split("/")[1] for name in names if name.startswith("binaries/") and "." in name})
        raise PlantError(
            f"{path}: no binary for this machine ({folder}); it holds: {', '.join(held) or 'none'}"
        )
    return description


def loaded(
    owner: object, path: Path, description: Any, messages: deque[str]
) -> tuple[Any, Vault | None, "weakref.finalize[..., Any]"]:
    """Unzip, load and instantiate; return FMPy's instance, its states, and what undoes all of it, once."""
    folder = tempfile.mkdtemp(prefix="firmware-bridge-plant-")
    try:
        fmpy.extract(str(path), folder)
        second = description.fmiVersion.startswith("2")
        kind = fmi2.FMU2Slave if second else fmi3.FMU3Slave
        # FMPy goes to the library's folder, and stays there where it cannot be loaded.
        with contextlib.chdir(Path.cwd()):
            plant = kind(
                guid=description.guid,
                unzipDirectory=folder,
                modelIdentifier=description.coSimulation.modelIdentifier,
                instanceName=description.modelName,
                requireFunctions=False,
            )
    except Exception as error:
        shutil.rmtree(folder, ignore_errors=True)
        raise PlantError(f"{path}: the FMU cannot be loaded: {error}") from error
    number = 0
    try:
        if second:
            callbacks, number = listened(messages)
            plant.instantiate(loggingOn=True, callbacks=callbacks)
        else:
            plant.instantiate(loggingOn=True, logMessage=_listener3(messages))
    except Exception as error:
        forgotten(number)
        plant.freeLibrary()
        shutil.rmtree(folder, ignore_errors=True)
        stated = messages[-1] if messages else error
        raise PlantError(f"{path}: the FMU cannot be instantiated: {stated}") from error
    vault = None
    # The functions are in every library; only those of an FMU that declares them do anything.
    if description.coSimulation.canGetAndSetFMUstate:
        vault = Vault(plant.dll, component_of(plant), int(description.fmiVersion[0]))
    return plant, vault, weakref.finalize(owner, _release, plant, vault, folder, number)


def component_of(plant: Any) -> int:
    """Return the address of FMPy's instance."""
    return int(getattr(plant.component, "value", plant.component))


def _release(plant: Any, vault: Vault | None, folder: str, number: int) -> None:
    if vault is not None:
        # Copies belong to the instance: they are freed before it.
        vault.close()
    # Freeing an instance is allowed in every state; fmi*Terminate is not, and adds nothing here.
    plant.freeInstance()
    forgotten(number)
    shutil.rmtree(folder, ignore_errors=True)


def _listener3(messages: deque[str]) -> Callable[[Any, int, bytes, bytes], None]:
    def listen(_environment: Any, status: int, _category: bytes, message: bytes) -> None:
        if status >= OK_OR_WARNING:
            messages.append(message.decode(errors="replace"))

    return listen


def _listen2(environment: int | None, name: bytes, status: int, category: bytes, message: bytes) -> None:
    """Take a message of FMI 2.0, its arguments filled in, for the instance that it is of."""
    messages = _RECEIVED.get(environment or 0)
    if messages is None:
        # Of an instance that someone else in this process has made with FMPy.
        fmi2.printLogMessage(environment, name, status, category, message)
    elif status >= OK_OR_WARNING:
        messages.append(message.decode(errors="replace"))


_RECEIVED: Final[dict[int, deque[str]]] = {}
"""The messages of each instance of FMI 2.0, by its number."""
_NUMBERS: Final = count(1)
_LISTENER: Final = fmi2.fmi2CallbackLoggerTYPE(_listen2)
"""FMPy's proxy, which fills in printf's arguments, keeps one logger for the whole process: this one."""


def listened(messages: deque[str]) -> tuple[Any, int]:
    """Return the callbacks of one instance of FMI 2.0, and its number."""
    callbacks, number = fmi2.fmi2CallbackFunctions(), next(_NUMBERS)
    callbacks.logger = _LISTENER
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
    # A number in place of a pointer: the one logger finds the instance's messages by it.
    callbacks.componentEnvironment = number
    _RECEIVED[number] = messages
    addLoggerProxy(ctypes.byref(callbacks))
    return callbacks, number


def forgotten(number: int) -> None:
    """Take no more messages of an instance of FMI 2.0; 0 is none."""
    _RECEIVED.pop(number, None)
