"""Build of the package's native parts; pyproject.toml has all the rest.

The servo kernel is a plain shared library beside its source. Without a C compiler the package installs all
the same, and the reference implementation in Python serves.

The environment selects a wheel's further contents:

* FIRMWARE_BRIDGE_COMPILE=1: the modules that every packet passes through, translated to C by mypyc (see
  docs/decisions/reproducible-runs.md); 0: nothing native at all, so that the wheel fits every machine.
* FIRMWARE_BRIDGE_PLANTS=1: the plants' FMUs for this machine, so that its installation needs no compiler.
"""

import hashlib
import os
import sys
import tomllib
from pathlib import Path
from typing import Final

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext
from setuptools.command.build_py import build_py

FOLDER: Final = Path("emulators") / "servo" / "native"
FILES: Final = sorted(FOLDER.glob("*.[ch]"))
# Contraction into fused multiply-adds would make the plant's inputs depend on compiler and CPU.
SAME_EVERYWHERE: Final = "-ffp-contract=off"
UNIX_FLAGS: Final = ["-std=c99", "-O2", "-fvisibility=hidden"]

MYPYC: Final = "mypy[mypyc]>=2.4,<3"
FOR_PLANTS: Final = ("fmpy>=0.3.22", "numpy>=1.26", "sympy>=1.12")
WAY_OF_A_PACKET: Final = (
    "emulators/arduino_omni/ar2/*.py",
    "emulators/arduino_omni/board.py",
    "emulators/arduino_omni/mega/*.py",
    "emulators/arduino_omni/motors.py",
    "emulators/arduino_omni/shield/*.py",
    "emulators/arduino_omni/shield_motors.py",
    "emulators/arduino_omni/sketches/*.py",
    "emulators/arduino_omni/usb_board.py",
    "emulators/bench/controls.py",
    "emulators/bench/operator.py",
    "emulators/bench/orders.py",
    "emulators/bench/stick.py",
    "emulators/canopen/*.py",
    "emulators/cia402/[!f]*.py",
    "emulators/drive/*.py",
    "emulators/epos2/canopen/*.py",
    "emulators/epos2/control/*.py",
    "emulators/epos2/drive.py",
    "emulators/epos2/io/*.py",
    "emulators/epos2/modes/*.py",
    "emulators/epos2/objects/*.py",
    "emulators/epos2/serial/*.py",
    "emulators/motion_capture/[bces]*.py",
    "emulators/motion_capture/film.py",
    "emulators/physics.py",
    "emulators/rig.py",
    "emulators/servo/bank.py",
    "emulators/servo/motor.py",
    "emulators/servo/scaling.py",
    "emulators/trace.py",
    "emulators/wires/*.py",
    "emulators/world.py",
    "firmware_bridge/bridge/*.py",
    "firmware_bridge/canopen/*.py",
    "firmware_bridge/canopen_drive/driver/*.py",
    "firmware_bridge/canopen_drive/guard/*.py",
    "firmware_bridge/differential/*.py",
    "firmware_bridge/drivers/*.py",
    "firmware_bridge/families/*/driver/*.py",
    "firmware_bridge/families/*/driver/*/*.py",
    "firmware_bridge/families/*/guard.py",
    "firmware_bridge/families/*/guard/*.py",
    "firmware_bridge/families/ar2/wire.py",
    "firmware_bridge/families/motion_capture/wire/*.py",
    "firmware_bridge/families/motor_shield/wire/*.py",
    "firmware_bridge/immutable.py",
    "firmware_bridge/intent.py",
    "firmware_bridge/mavlink/*.py",
    "firmware_bridge/motion/*.py",
    "firmware_bridge/packet.py",
    "firmware_bridge/robots/*/*.py",
    "firmware_bridge/safety/*.py",
    "firmware_bridge/safety/guard/*.py",
    "firmware_bridge/teleop/*.py",
    "firmware_bridge/wire/*.py",
)
"""Modules that run again and again in a mission; tables, and those that run once, stay as they are."""
INTERPRETED: Final = frozenset(
    {
        "emulators/epos2/objects/device_profile.py",  # its annotations carry sources, read at run time
        "firmware_bridge/canopen/abort.py",  # an enumeration with a __new__ of its own
        "firmware_bridge/canopen/data_type.py",  # an enumeration with an __init__ of its own
        "firmware_bridge/canopen/object_dictionary.py",  # a mapping, by the rules of Python's
        "firmware_bridge/canopen/object_row.py",  # a table
        "firmware_bridge/differential/geometry.py",  # its tables are pydantic's
        "firmware_bridge/motion/tables.py",  # as above
        "firmware_bridge/robots/ar2/geometry.py",  # as above
        "firmware_bridge/robots/climber/geometry.py",  # as above
        "firmware_bridge/robots/rars/geometry.py",  # as above
        "firmware_bridge/robots/rome/geometry.py",  # as above
        "firmware_bridge/robots/rome_arm/geometry.py",  # as above
        "firmware_bridge/teleop/station.py",  # its rows are generic dataclasses
    }
)
"""Modules that mypyc cannot translate, or that run once."""


class SharedLibrary(Extension):
    """A library that is loaded by its path: no module's name, no PyInit, no Python headers."""


class Build(build_ext):
    """Builds libraries, and modules of Python."""

    def get_ext_filename(self, ext_name: str) -> str:
        """Return `libservo.so` or `libservo.dll` in the library's folder; for a module what Python wants."""
        if isinstance(self.ext_map.get(ext_name), SharedLibrary):
            return str(Path(*ext_name.split("."))) + (".dll" if sys.platform == "win32" else ".so")
        return str(super().get_ext_filename(ext_name))

    def get_export_symbols(self, ext: Extension) -> list[str]:
        """Export nothing of a library by name: its source sets the visibility."""
        if isinstance(ext, SharedLibrary):
            return list(ext.export_symbols)
        return list(super().get_export_symbols(ext))

    def build_extension(self, ext: Extension) -> None:
        """Compile with the flags that this compiler understands."""
        if self.compiler.compiler_type != "msvc":
            own = UNIX_FLAGS if isinstance(ext, SharedLibrary) else []
            ext.extra_compile_args = [*ext.extra_compile_args, *own, SAME_EVERYWHERE]
        super().build_extension(ext)


class WithPlants(build_py):
    """Build step that copies the modules, and lays the plants' FMUs beside them."""

    def run(self) -> None:
        """Build each plant that pyproject.toml names, for FMI 2.0 and 3.0, or take it from the cache."""
        super().run()
        sys.path.insert(0, str(Path.cwd()))  # what is installed is not yet this package
        from fmu.build import place  # noqa: PLC0415 - as above
        from fmu.plants import find  # noqa: PLC0415 - as above
        from fmu.ready import FOLDER as READY  # noqa: PLC0415 - as above
        from fmu.ready import file_name  # noqa: PLC0415 - as above

        project = tomllib.loads(Path("pyproject.toml").read_text(encoding="utf-8"))["project"]
        for name in project["entry-points"]["firmware_bridge.plants"]:
            plant = find(name)
            for fmi in (2, 3):
                place(plant, fmi, Path(self.build_lib, "fmu", READY.name, file_name(plant, fmi)))


def built_from() -> str:
    """Return the first 64 bits of the sources' SHA-256: they identify a library older than its source."""
    digest = hashlib.sha256()
    for file in FILES:
        digest.update(file.read_bytes())
    return f"0x{digest.hexdigest()[:16]}"


def kernel() -> Extension:
    """Return the servo kernel."""
    return SharedLibrary(
        "emulators.servo.libservo",
        sources=[str(file) for file in FILES if file.suffix == ".c"],
        depends=[str(file) for file in FILES if file.suffix == ".h"],
        define_macros=[("SERVO_SOURCE", built_from())],
        optional=True,
    )


def compiled() -> list[Extension]:
    """Return the modules to compile. A wheel has them only: in a checkout they would hide what is edited."""
    if "bdist_wheel" not in sys.argv:
        return []
    from mypyc.build import mypycify  # noqa: PLC0415 - needed for this alone

    files = {str(file) for pattern in WAY_OF_A_PACKET for file in Path().glob(pattern)}
    chosen = sorted(file for file in files - INTERPRETED if not file.endswith("__init__.py"))
    options = ["--ignore-missing-imports", "--follow-imports=silent"]
    modules = mypycify(
        [*options, *chosen], opt_level="2", debug_level="0", multi_file=True, group_name="firmware_bridge"
    )
    return list(modules)


COMPILE: Final = os.environ.get("FIRMWARE_BRIDGE_COMPILE", "")
PLANTS: Final = os.environ.get("FIRMWARE_BRIDGE_PLANTS", "") == "1"

setup(
    cmdclass={"build_ext": Build, **({"build_py": WithPlants} if PLANTS else {})},
    ext_modules=[*([] if COMPILE == "0" else [kernel()]), *(compiled() if COMPILE == "1" else [])],
    options={"build_ext": {"parallel": os.cpu_count()}},
    setup_requires=[*([MYPYC] if COMPILE == "1" else []), *(FOR_PLANTS if PLANTS else ())],
)
