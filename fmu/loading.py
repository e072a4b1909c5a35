"""Unzip, check, load and instantiate an FMU with FMPy, and undo all of it, once.

It refuses to know variables: only whether this machine can run the file as a slave.
"""

import contextlib
import shutil
import tempfile
import weakref
from collections import deque
from collections.abc import Callable
from functools import lru_cache
from pathlib import Path
from typing import Any
from zipfile import BadZipFile, ZipFile

import fmpy
from fmpy import fmi2, fmi3
from fmpy.model_description import read_model_description

from fmu.calls import OK_OR_WARNING
from fmu.errors import PlantError
from fmu.states import Vault


def described(path: Path) -> Any:
    """Return FMPy's model description after all of its checks."""
    if not path.is_file():
        raise PlantError(f"{path}: there is no such file; give the path of an FMU")
    try:
        with ZipFile(path) as archive:
            members = tuple((member.filename, member.CRC) for member in archive.infolist())
    except (BadZipFile, OSError) as error:
        raise PlantError(f"{path}: not an FMU: {error}") from error
    return _described(path, members)


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
    try:
        if second:
            plant.instantiate(loggingOn=True, callbacks=_callbacks(messages))
        else:
            plant.instantiate(loggingOn=True, logMessage=_listener3(messages))
    except Exception as error:
        plant.freeLibrary()
        shutil.rmtree(folder, ignore_errors=True)
        said = messages[-1] if messages else error
        raise PlantError(f"{path}: the FMU cannot be instantiated: {said}") from error
    vault = None
    if description.coSimulation.canGetAndSetFMUstate:
        vault = Vault(plant.dll, component_of(plant), int(description.fmiVersion[0]))
    return plant, vault, weakref.finalize(owner, _release, plant, vault, folder)


def component_of(plant: Any) -> int:
    """Return the address of FMPy's instance."""
    return int(getattr(plant.component, "value", plant.component))


def _release(plant: Any, vault: Vault | None, folder: str) -> None:
    if vault is not None:
        vault.close()
    # Freeing an instance is allowed in every state; fmi*Terminate is not, and adds nothing here.
    plant.freeInstance()
    shutil.rmtree(folder, ignore_errors=True)


def _listener3(messages: deque[str]) -> Callable[[Any, int, bytes, bytes], None]:
    def listen(_environment: Any, status: int, _category: bytes, message: bytes) -> None:
        if status >= OK_OR_WARNING:
            messages.append(message.decode(errors="replace"))

    return listen


def _callbacks(messages: deque[str]) -> Any:
    def listen(_environment: Any, _name: bytes, status: int, _category: bytes, message: bytes) -> None:
        if status >= OK_OR_WARNING:
            messages.append(message.decode(errors="replace"))

    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(listen)
    callbacks.allocateMemory = fmi2.fmi2CallbackAllocateMemoryTYPE(fmpy.calloc)
    callbacks.freeMemory = fmi2.fmi2CallbackFreeMemoryTYPE(fmpy.free)
    # FMPy's proxy, which would fill in printf arguments, keeps one logger for the whole process, and calls
    # it after it is gone: messages are taken as they are.
    return callbacks
