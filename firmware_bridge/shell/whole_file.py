"""Writes a small file whole: a crash leaves the old one or the new one."""

import os
from pathlib import Path


def replace(path: Path, text: str) -> None:
    """Replace a file, and make its folder where there is none; OSError where it cannot be written."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f"{path.name}.{os.getpid()}")
    fresh.write_text(text, encoding="utf-8")
    fresh.replace(path)
