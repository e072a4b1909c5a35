"""A package that is installed beside the product, as a user does it, and what of the product has changed."""

import os
import subprocess
import sys
from pathlib import Path
from typing import Final

ROOT: Final = Path(__file__).parents[2]
PRODUCT: Final = ("firmware_bridge", "emulators", "fmu", "examples")
BRIDGE: Final = "from firmware_bridge.cli import main; main()"


def files() -> dict[Path, int]:
    """Return every file of the product with the time of its last change; caches and builds are none."""
    found = [path for name in PRODUCT for path in (ROOT / name).rglob("*") if path.is_file()]
    return {path: path.stat().st_mtime_ns for path in found if path.suffix not in {".pyc", ".so"}}


class Beside:
    """A folder with a package installed in it, beside the product."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.site = folder / "site"
        # Plants are kept by their content: one that was built before is not built again.
        self.environment = {
            **os.environ,
            "PYTHONPATH": os.pathsep.join([str(self.site), *filter(None, [os.environ.get("PYTHONPATH")])]),
            "NO_COLOR": "1",
        }

    def run(self, *words: str, **more: str) -> str:
        done = self._done(*words, **more)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    def fails(self, *words: str) -> str:
        """Run a command of the bridge that is to fail; return its message."""
        done = self._done("-c", BRIDGE, *words)
        assert done.returncode != 0, done.stdout
        return done.stdout + done.stderr

    def _done(self, *words: str, **more: str) -> subprocess.CompletedProcess[str]:
        return subprocess.run(
            [sys.executable, "-P", *words],
            cwd=self.folder,
            env={**self.environment, **more},
            capture_output=True,
            text=True,
            check=False,
        )

    def bridge(self, *words: str) -> str:
        return self.run("-c", BRIDGE, *words)

    def installs(self, name: str) -> None:
        offline = (
            "--no-deps",
            "--no-build-isolation",
            "--no-index",
            "--disable-pip-version-check",
            "--quiet",
        )
        self.run("-m", "pip", "install", *offline, "--target", str(self.site), name)
