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
import sys
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from importlib import metadata
from pathlib import Path
from typing import TYPE_CHECKING, Final
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from fmu.errors import PlantError
from fmu.export.about import About
from fmu.fingerprint import RESOURCE
from fmu.plants import UNKNOWN, Plant, find, origin
from fmu.platforms import FLAGS, Platform, find_compiler, here, library, version_text
from fmu.ready import ready
from fmu.sources import folder_of, token_of

if TYPE_CHECKING:
    from fmu.export.model import Model

_HERE: Final = Path(__file__).parent
_VERSIONS: Final = (2, 3)
_SHARED: Final = ("core.c", "exchange.c", "messages.c", "slopes.c", "states.c", "step.c")
_GENERATED: Final = ("model.c", "tangents.c")
_HEADERS: Final = ("compiler.h", "core.h", "elementary.h")
_EPOCH: Final = (1980, 1, 1, 0, 0, 0)


def ensure(plant: str | Plant, fmi: int = 3, others: Sequence[Platform] = ()) -> Path:
    """Return the FMU of this plant, or of the installed one of this name, for FMI 2.0 or 3.0.

    It holds a binary for this machine, and for `others`, whose compilers must be here. It is the one that
    came with the package; where none did, it is built when it is not in the cache. PlantError where it cannot
    be.
    """
    chosen = find(plant) if isinstance(plant, str) else plant
    came = ready(chosen, fmi)
    if came is not None and not others:
        return came
    compiler = find_compiler()
    own = came or _kept(chosen, fmi, compiler)
    target = _kept(chosen, fmi, compiler, others) if others else own
    if target.exists():
        return target
    if not own.exists():
        build(chosen, fmi, own, compiler=compiler)
    if target != own:
        _put(target, _with_binaries(own, fmi, others))
    return target


def is_built(plant: str | Plant, fmi: int = 3) -> bool:
    """Return whether the FMU of this plant is there, so that `ensure` takes no time; PlantError as there."""
    chosen = find(plant) if isinstance(plant, str) else plant
    return ready(chosen, fmi) is not None or _kept(chosen, fmi, find_compiler()).exists()


def place(plant: str | Plant, fmi: int, target: Path, others: Sequence[Platform] = ()) -> None:
    """Write the FMU of this plant, as `ensure` keeps it, replacing `target` at once."""
    _put(target, ensure(plant, fmi, others).read_bytes())


def build(plant: str | Plant, fmi: int, target: Path, *, compiler: str | None = None) -> None:
    """Write the FMU of this plant, or of the installed one of this name, replacing `target` at once."""
    chosen = find(plant) if isinstance(plant, str) else plant
    token = f"{{{token_of(chosen)}}}"
    export(chosen.model(), fmi, target, token=token, about=_about(chosen), compiler=compiler)


def export(
    model: "Model",
    fmi: int,
    target: Path,
    *,
    token: str,
    about: About = UNKNOWN,
    compiler: str | None = None,
) -> None:
    """Write any equations as an FMU; `token` identifies its version. PlantError where that fails."""
    if fmi not in _VERSIONS:
        raise PlantError(f"FMI {fmi} is not offered: 2 or 3")
    blocks, code, description, documentation, reference_model = (
        importlib.import_module(f"fmu.export.{name}")
        for name in ("blocks", "code", "description", "documentation", "reference_model")
    )
    program, units = blocks.ModelCode(model), _units(fmi)
    written = (*_HEADERS, f"fmi{fmi}_shell.h", *(unit for unit in units if unit not in _GENERATED))
    files = {name: (_HERE / "export" / "c" / name).read_text(encoding="utf-8") for name in written}
    files |= code.generate(program, token, files["core.h"]) | _fmi_headers(fmi)
    texts = {f"sources/{name}": text for name, text in files.items()}
    texts |= documentation.documentation(program, about)
    texts["modelDescription.xml"] = description.DESCRIPTIONS[fmi](program, token, units, about)
    if fmi > 2:  # noqa: PLR2004 - since FMI 3.0 the sources have a description of their own
        texts["sources/buildDescription.xml"] = description.fmi3_build(program, units, FLAGS)
    fingerprint = reference_model.fingerprint(program)
    # Without one the FMU is used unchecked: Python cannot follow a run that divides by zero.
    if fingerprint is not None:
        texts[RESOURCE] = fingerprint.to_json()
    entries = {name: text.encode() for name, text in texts.items()}
    entries[here().binary(model.name, fmi)] = library(files, units, compiler or find_compiler())
    _put(target, _zipped(entries))


def _with_binaries(fmu: Path, fmi: int, others: Sequence[Platform]) -> bytes:
    """Return an FMU with binaries for other machines beside its own, from the sources that it carries."""
    with ZipFile(fmu) as archive:
        entries = {name: archive.read(name) for name in archive.namelist()}
    own = next(name for name in entries if name.startswith("binaries/"))
    files = {
        name.removeprefix("sources/"): content.decode()
        for name, content in entries.items()
        if name.startswith("sources/")
    }
    for other in others:
        compiler = shutil.which(other.compiler)
        if compiler is None:
            raise PlantError(f"no {other.compiler} for {other.name}: install Debian's {other.package}")
        entries[other.binary(Path(own).stem, fmi)] = library(files, _units(fmi), compiler, other.flags)
    return _zipped(entries)


def _units(fmi: int) -> tuple[str, ...]:
    """Return the C files that are compiled, in order."""
    return (*_SHARED, *(f"fmi{fmi}{part}.c" for part in ("", "_absent", "_exchange", "_states")), *_GENERATED)


def _about(plant: Plant) -> About:
    """Return the origin of a plant's package, and the plant's own page."""
    page = folder_of(plant, plant.package) / "README.md"
    return replace(origin(plant), page=page.read_text(encoding="utf-8") if page.is_file() else "")


def _kept(plant: Plant, fmi: int, compiler: str, others: Sequence[Platform] = ()) -> Path:
    more = "".join(f"-{other.folder}" for other in others)
    return _cache() / f"{plant.name}-fmi{fmi}{more}-{_key(plant, fmi, compiler, others)[:16]}.fmu"


def _cache() -> Path:
    root = os.environ.get("XDG_CACHE_HOME") or str(Path.home() / ".cache")
    return Path(root) / "firmware-bridge" / "fmu"


def _key(plant: Plant, fmi: int, compiler: str, others: Sequence[Platform]) -> str:
    # Another version of the compiler may give another binary: it is another FMU.
    digest = hashlib.sha256(version_text(compiler))
    for other in others:
        digest.update(version_text(shutil.which(other.compiler) or "true") + repr(other).encode())
    about = repr(origin(plant))
    parts = (
        token_of(plant),
        about,
        str(fmi),
        compiler,
        *FLAGS,
        *_libraries(),
        platform.machine(),
        sys.platform,
    )
    # The zero byte keeps neighbors apart: "ab", "c" is not "a", "bc".
    for part in parts:
        digest.update(part.encode() + b"\0")
    return digest.hexdigest()


@cache
def _libraries() -> tuple[str, ...]:
    try:
        return tuple(f"{name} {metadata.version(name)}" for name in ("sympy", "fmpy"))
    except metadata.PackageNotFoundError as error:
        raise PlantError(
            f"a plant is built with {error.name}, which is not here: pip install 'firmware-bridge[plants]'"
        ) from None


def _fmi_headers(fmi: int) -> dict[str, str]:
    """Return FMI's C headers from the installed FMPy, without importing it."""
    spec = importlib.util.find_spec("fmpy")
    if spec is None or not spec.submodule_search_locations:
        raise PlantError("FMPy is not installed, and FMI's C headers come with it: pip install fmpy")
    folder = Path(spec.submodule_search_locations[0]) / "c-code"
    found = sorted(folder.glob(f"fmi{fmi}*.h"))
    if not found:
        raise PlantError(f"the installed FMPy has no headers of FMI {fmi} in {folder}: install fmpy>=0.3.22")
    return {path.name: path.read_text(encoding="utf-8") for path in found}


def _zipped(entries: Mapping[str, bytes]) -> bytes:
    content = io.BytesIO()
    with ZipFile(content, "w", ZIP_DEFLATED) as archive:
        for path in sorted(entries):
            # A fixed date and order of the entries: two builds are the same bytes.
            entry = ZipInfo(path, _EPOCH)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, entries[path], ZIP_DEFLATED)
    return content.getvalue()


def _put(target: Path, content: bytes) -> None:
    try:
        target.parent.mkdir(parents=True, exist_ok=True)
        # In the target's own folder: a rename is atomic only within one file system.
        handle, name = tempfile.mkstemp(dir=target.parent, prefix=f".{target.stem}-", suffix=".part")
        aside = Path(name)
        try:
            with os.fdopen(handle, "wb") as stream:
                stream.write(content)
            aside.chmod(0o644)
            aside.replace(target)
        # Also on Ctrl-C: a half-written file must not stay beside the cache's own.
        except BaseException:
            aside.unlink(missing_ok=True)
            raise
    except OSError as error:
        reason = error.strerror or error
        remedy = "name another place (XDG_CACHE_HOME moves the cache)"
        raise PlantError(f"{target}: the FMU cannot be written here: {reason}; {remedy}") from error
