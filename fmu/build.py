"""Build a plant's FMU once and keep it: equations, C compiler, archive, cache.

Several processes may build at once: each builds aside and moves the result into place.
"""

import hashlib
import importlib
import importlib.util
import io
import os
import platform
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping, Sequence
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Final
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from fmu.errors import PlantError
from fmu.fingerprint import RESOURCE
from fmu.plants import Plant, find

if TYPE_CHECKING:
    from fmu.export.model import Model

FLAGS: Final = (
    "-std=c99", "-O3", "-fno-guess-branch-probability", "-fno-math-errno", "-fno-trapping-math",
    "-ffp-contract=off", "-fPIC", "-fvisibility=hidden",
)  # fmt: skip
"""Nobody asks for errno or traps, and without them roots and choices take no branches; the bits are the same.
gcc guesses on which side of a bound a value lies, and moves the other side away: 7 % of a run's time.
Contraction into fused multiply-adds would make the result depend on compiler and CPU."""

_HERE: Final = Path(__file__).parent
_COMPILERS: Final = ("cc", "gcc", "clang")
_VERSIONS: Final = (2, 3)
_SHARED: Final = ("core.c", "exchange.c", "messages.c", "slopes.c", "states.c", "step.c")
_GENERATED: Final = ("model.c", "tangents.c")
_EPOCH: Final = (1980, 1, 1, 0, 0, 0)


def ensure(plant: str | Plant, fmi: int = 3) -> Path:
    """Return the FMU of this plant, or of the installed one of this name, for FMI 2.0 or 3.0.

    It is built when it is not in the cache. PlantError where it cannot be.
    """
    chosen = find(plant) if isinstance(plant, str) else plant
    compiler = find_compiler()
    target = _kept(chosen, fmi, compiler)
    if not target.exists():
        build(chosen, fmi, target, compiler=compiler)
    return target


def is_built(plant: str | Plant, fmi: int = 3) -> bool:
    """Tell whether the FMU of this plant is in the cache, so that `ensure` takes no time."""
    chosen = find(plant) if isinstance(plant, str) else plant
    return _kept(chosen, fmi, find_compiler()).exists()


def place(plant: str | Plant, fmi: int, target: Path) -> None:
    """Write the FMU of this plant, as `ensure` keeps it, replacing `target` at once."""
    _put(target, ensure(plant, fmi).read_bytes())


def build(plant: str | Plant, fmi: int, target: Path, *, compiler: str | None = None) -> None:
    """Write the FMU of this plant, or of the installed one of this name, replacing `target` at once."""
    chosen = find(plant) if isinstance(plant, str) else plant
    export(chosen.model(), fmi, target, token=f"{{{_token(chosen)}}}", compiler=compiler)


def export(model: "Model", fmi: int, target: Path, *, token: str, compiler: str | None = None) -> None:
    """Write any equations as an FMU; `token` tells its versions apart. PlantError where that fails."""
    if fmi not in _VERSIONS:
        raise PlantError(f"FMI {fmi} is not offered: 2 or 3")
    blocks, code, description, twin = (
        importlib.import_module(f"fmu.export.{name}") for name in ("blocks", "code", "description", "twin")
    )
    program = blocks.Program(model)
    shell = [f"fmi{fmi}{part}.c" for part in ("", "_absent", "_exchange", "_states")]
    units = (*_SHARED, *shell, *_GENERATED)
    written = ("core.h", "elementary.h", f"fmi{fmi}_shell.h", *_SHARED, *shell)
    files = {name: (_HERE / "export" / "c" / name).read_text(encoding="utf-8") for name in written}
    files |= code.generate(program, token) | _headers(fmi)
    entries = {f"sources/{name}": text.encode() for name, text in files.items()}
    entries["modelDescription.xml"] = description.DESCRIPTIONS[fmi](program, token, units).encode()
    if fmi > 2:  # noqa: PLR2004 - since FMI 3.0 the sources have a description of their own
        entries["sources/buildDescription.xml"] = description.fmi3_build(program, units).encode()
    fingerprint = twin.fingerprint(program)
    if fingerprint is not None:
        entries[RESOURCE] = fingerprint.to_json().encode()
    entries[_binary_path(model.name, fmi)] = _compiled(files, units, compiler or find_compiler())
    _put(target, _zipped(entries))


def find_compiler() -> str:
    """Return the path of a C compiler: $CC, else the first of cc, gcc, clang."""
    chosen = os.environ.get("CC")
    for name in (chosen,) if chosen else _COMPILERS:
        path = shutil.which(name)
        if path:
            return path
    if chosen:
        raise PlantError(f"the C compiler $CC = {chosen} was not found: correct it, or unset CC")
    raise PlantError(f"no C compiler found (tried {', '.join(_COMPILERS)}): install one, e.g. Debian's gcc")


def _kept(plant: Plant, fmi: int, compiler: str) -> Path:
    return _cache() / f"{plant.name}-fmi{fmi}-{_key(plant, fmi, compiler)[:16]}.fmu"


def _cache() -> Path:
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "firmware-bridge" / "fmu"


def _sources(plant: Plant) -> Iterator[tuple[str, Path]]:
    """Yield what the FMU is made from: a name that is the same on every machine, and the file."""
    yield "fingerprint.py", _HERE / "fingerprint.py"
    folders = {"export": _HERE / "export", "parts": _HERE / "parts", plant.package: _folder(plant)}
    for name, folder in folders.items():
        for path in sorted(folder.rglob("*")):
            if path.suffix in {".py", ".c", ".h"}:
                yield f"{name}/{path.relative_to(folder).as_posix()}", path


def _folder(plant: Plant) -> Path:
    try:
        spec = importlib.util.find_spec(plant.package)
    except ImportError:
        spec = None
    if spec is None or not spec.submodule_search_locations:
        raise PlantError(
            f"the plant '{plant.name}' is to stand in the package {plant.package}: there is none"
        )
    return Path(spec.submodule_search_locations[0])


def _token(plant: Plant) -> str:
    digest = hashlib.sha256()
    for name, path in _sources(plant):
        digest.update(name.encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()[:32]


def _key(plant: Plant, fmi: int, compiler: str) -> str:
    # The compiler is the user's own choice.
    version = subprocess.run([compiler, "--version"], capture_output=True, check=False).stdout  # noqa: S603
    digest = hashlib.sha256(version)
    libraries = [f"{name} {metadata.version(name)}" for name in ("sympy", "fmpy")]
    for part in (_token(plant), str(fmi), compiler, *FLAGS, *libraries, platform.machine(), sys.platform):
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()


def _headers(fmi: int) -> dict[str, str]:
    """Return FMI's C headers from the installed FMPy, without importing it."""
    spec = importlib.util.find_spec("fmpy")
    if spec is None or not spec.submodule_search_locations:
        raise PlantError("FMPy is not installed, and FMI's C headers come with it: pip install fmpy")
    folder = Path(spec.submodule_search_locations[0]) / "c-code"
    found = sorted(folder.glob(f"fmi{fmi}*.h"))
    if not found:
        raise PlantError(f"the installed FMPy has no headers of FMI {fmi} in {folder}: install fmpy>=0.3.22")
    return {path.name: path.read_text(encoding="utf-8") for path in found}


def _compiled(files: Mapping[str, str], units: Sequence[str], compiler: str) -> bytes:
    with tempfile.TemporaryDirectory(prefix="firmware-bridge-build-") as name:
        folder = Path(name)
        for file, text in files.items():
            (folder / file).write_text(text, encoding="utf-8")
        # Relative names, so that no path of this machine gets into the binary.
        command = [compiler, *FLAGS, "-shared", "-s", "-o", "plant.so", *units, "-lm"]
        run = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)  # noqa: S603
        if run.returncode:
            raise PlantError(f"{' '.join(command)} failed:\n{run.stderr.strip()}")
        return (folder / "plant.so").read_bytes()


def _binary_path(identifier: str, fmi: int) -> str:
    system, suffix = {"darwin": ("darwin", ".dylib"), "win32": ("windows", ".dll")}.get(
        sys.platform, ("linux", ".so")
    )
    machine = platform.machine().lower()
    architecture = {"amd64": "x86_64", "arm64": "aarch64"}.get(machine, machine)
    if fmi == 2:  # noqa: PLR2004 - the version
        short = {"windows": "win"}.get(system, system)
        return f"binaries/{short}64/{identifier}{suffix}"
    return f"binaries/{architecture}-{system}/{identifier}{suffix}"


def _zipped(entries: Mapping[str, bytes]) -> bytes:
    content = io.BytesIO()
    with ZipFile(content, "w", ZIP_DEFLATED) as archive:
        for path in sorted(entries):
            entry = ZipInfo(path, _EPOCH)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, entries[path], ZIP_DEFLATED)
    return content.getvalue()


def _put(target: Path, content: bytes) -> None:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=".part")
        aside = Path(name)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
            aside.chmod(0o644)
            aside.replace(target)
        except BaseException:
            aside.unlink(missing_ok=True)
            raise
    except OSError as error:
        reason = error.strerror or error
        cure = "name another place (XDG_CACHE_HOME moves the cache)"
        raise PlantError(f"{target}: the FMU cannot be written here: {reason}; {cure}") from error
