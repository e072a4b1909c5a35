"""Collection of the facts of this machine. It opens no bus and no port, and sends nothing."""

import getpass
import os
import platform
import re
import shutil
import socket
import subprocess
import sys
import sysconfig
from collections.abc import Iterator
from contextlib import suppress
from importlib import metadata
from importlib.util import find_spec
from pathlib import Path
from typing import Final

from emulators.doctor.facts import (
    CanInterface,
    Facts,
    Library,
    SerialPort,
    Version,
    interfaces_of,
    version_of,
)
from emulators.servo import kernel
from emulators.servo.seam import ServoError
from firmware_bridge import robot_types
from firmware_bridge.robot import RobotFileError
from firmware_bridge.runtime.clock import Clock, resolution
from firmware_bridge.units import MILLISECOND, Nanoseconds
from fmu import plants
from fmu.build import is_built
from fmu.errors import PlantError
from fmu.platforms import find_compiler

PACKAGE: Final = "firmware-bridge"
SLEEP: Final[Nanoseconds] = 10 * MILLISECOND
SLEEPS: Final = 50
CORE: Final = (
    "emulators.epos2.drive",
    "emulators.world",
    "firmware_bridge.bridge.bridge",
    "firmware_bridge.packet",
    "firmware_bridge.safety.gate",
)
"""Examples of the modules that are translated together."""
_NETWORK: Final = Path("/sys/class/net")
_CAN_HARDWARE: Final = "280"
"""ARPHRD_CAN of <linux/if_arp.h>."""
_UP: Final = 1
"""The flag IFF_UP of <linux/if.h>."""
_LISTING_S: Final = 5.0
_NEEDED: Final = re.compile(
    r"(?P<name>[\w.-]+)(?:\[[^]]*\])?\s*(?:>=\s*(?P<least>[\w.]+))?[^;]*(?:;\s*(?P<marker>.*))?"
)
_EXTRA: Final = re.compile(r"extra\s*==\s*['\"](?P<name>[\w-]+)['\"]")


def gather(sleeps: int = SLEEPS) -> Facts:
    """Return the facts; with 50 sleeps that takes half a second."""
    found = None
    with suppress(PlantError):
        found = find_compiler()
    needed, extras = _requirements()
    return Facts(
        python=tuple(sys.version_info[:3]),
        system=platform.system(),
        release=platform.release(),
        socketcan=_socketcan(),
        vcan=_vcan(),
        interfaces=_interfaces(),
        ports=tuple(_ports()),
        user=_user(),
        resolution=resolution(),
        late=tuple(_late(sleeps)),
        load=_load(),
        # Those that this process may use: a container has fewer than its machine.
        processors=len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1,
        compiler=found,
        headers=Path(sysconfig.get_path("include"), "Python.h").exists(),
        kernel_built=(Path(kernel.__file__).parent / kernel.LIBRARY).exists(),
        kernel_problem=_kernel_problem(),
        compiled={name: _is_compiled(name) for name in CORE},
        plants={name: _is_built(name) or (None if found is None else False) for name in plants.names()},
        libraries=tuple(Library(name, least, _installed(name)) for name, least in needed),
        unwatched=dict(_unwatched()),
        extras={
            extra: tuple(name for name in names if _installed(name) is None)
            for extra, names in extras.items()
        },
    )


def _unwatched() -> Iterator[tuple[str, bool]]:
    """Yield the links of installed robots without a watchdog, and whether that is accepted."""
    for name in robot_types.robots():
        with suppress(RobotFileError):
            for link, table in robot_types.find(name).links.items():
                if table.unwatched:
                    yield f"{name}:{link}", table.accepts_unwatched


def _socketcan() -> bool:
    """Return whether a raw CAN socket can be made; it is bound to no interface, so no bus knows of it."""
    try:
        # Not bound: the test reaches no bus.
        socket.socket(socket.AF_CAN, socket.SOCK_RAW, socket.CAN_RAW).close()
    except (OSError, AttributeError):
        return False
    return True


def _vcan() -> bool:
    """Return whether the module is loaded, or could be."""
    if Path("/sys/module/vcan").exists():
        return True
    for name in ("modules.dep", "modules.builtin"):
        with suppress(OSError):
            if "/vcan.ko" in Path("/lib/modules", platform.release(), name).read_text(encoding="utf-8"):
                return True
    return False


def _interfaces() -> tuple[CanInterface, ...]:
    """Read the interfaces from `ip`, which knows all; else from the kernel's files: names, and up or down."""
    ip = shutil.which("ip")
    if ip is not None:
        with suppress(OSError, subprocess.TimeoutExpired):
            known = subprocess.run(  # noqa: S603 - it only lists
                [ip, "-j", "-details", "link"],
                capture_output=True,
                text=True,
                check=False,
                timeout=_LISTING_S,
            )
            if known.returncode == 0 and known.stdout.strip():
                return interfaces_of(known.stdout)
    return tuple(_in_files())


def _in_files() -> Iterator[CanInterface]:
    for folder in sorted(_NETWORK.glob("*")):
        with suppress(OSError, ValueError):
            if (folder / "type").read_text(encoding="ascii").strip() == _CAN_HARDWARE:
                flags = int((folder / "flags").read_text(encoding="ascii"), 16)
                yield CanInterface(folder.name, bool(flags & _UP), folder.name.startswith("vcan"))


def _ports() -> Iterator[SerialPort]:
    # pyserial alone knows where each system keeps them.
    from serial.tools import list_ports  # noqa: PLC0415 - see above

    for port in sorted(list_ports.comports()):
        # A name that is no file, as COM3, cannot be judged: it counts as allowed.
        allowed = os.access(port.device, os.R_OK | os.W_OK) or not Path(port.device).exists()
        title = "" if port.description in {None, "n/a"} else port.description
        yield SerialPort(port.device, title or "no description", allowed, _group(port.device))


def _group(device: str) -> str:
    with suppress(OSError, KeyError, ImportError, NotImplementedError):
        return Path(device).group()
    return ""


def _user() -> str:
    with suppress(OSError, KeyError, ImportError):
        return getpass.getuser()
    return "this user"


def _late(sleeps: int) -> Iterator[Nanoseconds]:
    """Sleep as the bridge does between two packets, and say how late each time was."""
    clock = Clock()
    for _ in range(sleeps):
        # As the bridge's own loop does it: on the same clock, by the same call.
        due = clock.now() + SLEEP
        clock.wait((), due)
        yield max(0, clock.now() - due)


def _load() -> float | None:
    with suppress(OSError, AttributeError):
        return os.getloadavg()[0]
    return None


def _kernel_problem() -> str:
    try:
        return kernel.choose().reason
    except ServoError as error:
        return str(error)


def _is_built(plant: str) -> bool:
    """Return whether a plant is in the cache; one that cannot be looked at is not."""
    with suppress(PlantError):
        return is_built(plant)
    return False


def _is_compiled(module: str) -> bool:
    spec = find_spec(module)
    return spec is not None and spec.origin is not None and not spec.origin.endswith(".py")


def _requirements() -> tuple[tuple[tuple[str, Version], ...], dict[str, tuple[str, ...]]]:
    """Return what this package needs with the least versions, and what each extra brings."""
    known = metadata.metadata(PACKAGE)
    needed: list[tuple[str, Version]] = []
    extras: dict[str, tuple[str, ...]] = dict.fromkeys(known.get_all("Provides-Extra") or (), ())
    for text in metadata.requires(PACKAGE) or ():
        fits = _NEEDED.fullmatch(text)
        if fits is None:
            continue
        extra = _EXTRA.search(fits["marker"] or "")
        if extra is not None:
            extras[extra["name"]] = (*extras.get(extra["name"], ()), fits["name"])
        else:
            needed.append((fits["name"], version_of(fits["least"] or "0")))
    return tuple(needed), extras


def _installed(name: str) -> Version | None:
    try:
        return version_of(metadata.version(name))
    except metadata.PackageNotFoundError:
        return None
