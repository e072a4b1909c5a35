"""The journal of a campaign: a line for each run as it ends; a killed campaign goes on where it was."""

import json
from pathlib import Path
from typing import Final, Self, TextIO

from emulators.campaign.plan import Plan
from emulators.campaign.results import Row, as_json, of_json
from firmware_bridge.robot.problems import FileError, Problem

NAME: Final = "runs.jsonl"


class JournalError(FileError):
    """A journal of another campaign, or none."""


class Journal:
    """Rows by their runs; use it in a `with`."""

    def __init__(self, folder: Path, plan: Plan) -> None:
        self._path = folder / NAME
        self._head = json.dumps({"campaign": plan.sha256, "runs": len(plan.runs)})
        self.rows: dict[int, Row] = {}
        folder.mkdir(parents=True, exist_ok=True)
        self._resume()
        self._file: TextIO | None = None

    def __enter__(self) -> Self:
        begun = self._path.exists()
        self._file = self._path.open("a", encoding="utf-8")
        if not begun:
            self._write(self._head)
        return self

    def __exit__(self, *_: object) -> None:
        if self._file is not None:
            self._file.close()

    def add(self, row: Row) -> None:
        """Keep a row; it is there whatever ends this process now."""
        self.rows[row.run] = row
        self._write(as_json(row))

    def _write(self, line: str) -> None:
        if self._file is not None:
            self._file.write(line + "\n")
            # Beyond this process at once: what a power cut takes is driven again.
            self._file.flush()

    def _resume(self) -> None:
        if not self._path.exists():
            return
        text = self._path.read_bytes()
        # A line without its end was being written when the process was killed.
        whole = text[: text.rfind(b"\n") + 1]
        # Not by every sign that ends a line for Python: an error's text may hold one.
        lines = whole.decode("utf-8").split("\n")[:-1]
        if lines and lines[0] != self._head:
            problem = "has another campaign's runs: choose another --out, or drive all again with --fresh"
            raise JournalError(str(self._path), Problem("", problem))
        if not lines:
            self._path.unlink()
            return
        if whole != text:
            self._path.write_bytes(whole)
        for number, line in enumerate(lines[1:], 2):
            try:
                row = of_json(line)
            except (ValueError, KeyError, TypeError) as error:
                raise JournalError(
                    str(self._path), Problem(f"line {number}", f"is no run: {error}")
                ) from error
            self.rows[row.run] = row
