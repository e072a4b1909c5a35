"""Builds the servo kernel as a plain shared library beside its source; pyproject.toml says all the rest.

Without a C compiler the package installs all the same, and the kernel's twin in Python serves.
"""

import hashlib
import sys
from pathlib import Path

from setuptools import Extension, setup
from setuptools.command.build_ext import build_ext

FOLDER = Path("emulators") / "servo" / "native"
FILES = sorted(FOLDER.glob("*.[ch]"))
# Contraction into fused multiply-adds would make the plant's inputs depend on compiler and CPU.
UNIX_FLAGS = ["-std=c99", "-O2", "-ffp-contract=off", "-fvisibility=hidden"]


class SharedLibrary(build_ext):
    """Builds a library that is loaded by its path: no module's name, no PyInit, no Python headers."""

    def get_ext_filename(self, ext_name: str) -> str:
        """Return `libservo.so` or `libservo.dll` in the extension's folder."""
        return str(Path(*ext_name.split("."))) + (".dll" if sys.platform == "win32" else ".so")

    def get_export_symbols(self, ext: Extension) -> list[str]:
        """Export nothing by name: the source says what is visible."""
        return list(ext.export_symbols)

    def build_extension(self, ext: Extension) -> None:
        """Compile with the flags that this compiler understands."""
        if self.compiler.compiler_type != "msvc":
            ext.extra_compile_args = UNIX_FLAGS
        super().build_extension(ext)


def built_from() -> str:
    """Return the first 64 bits of the sources' SHA-256: they tell a library that is older than its source."""
    digest = hashlib.sha256()
    for file in FILES:
        digest.update(file.read_bytes())
    return f"0x{digest.hexdigest()[:16]}"


setup(
    cmdclass={"build_ext": SharedLibrary},
    ext_modules=[
        Extension(
            "emulators.servo.libservo",
            sources=[str(file) for file in FILES if file.suffix == ".c"],
            depends=[str(file) for file in FILES if file.suffix == ".h"],
            define_macros=[("SERVO_SOURCE", built_from())],
            optional=True,
        )
    ],
)
