# ruff: noqa: INP001 - a script's neighbor, not a package
"""Choice of mutants for a run of ten minutes: the same ones for the same commit, at any time."""

import hashlib
import re
import subprocess
from collections.abc import Iterable, Mapping
from typing import Final

from mutants import ROOT, Mutant, mutants, path_of
from packages import hashes_of
from results import RESULTS, Result

OF_A_MODULE: Final = 40
"""Mutants of one module in a sample: to find out what tests reach is paid once for all of them."""


def git(*words: str) -> str:
    """Return git's output; empty where it fails."""
    done = subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=False)  # noqa: S603, S607 - ours
    return done.stdout.strip() if done.returncode == 0 else ""


def seed_of() -> int:
    """Return a number that the newest commit gives."""
    return int(git("rev-parse", "HEAD")[:8] or "0", 16)


def base() -> str:
    """Return the commit since which lines are new: where this branch left the origin's main.

    Where there is none, or nothing since, the commit of the last result; where there is no such, nothing.
    """
    head = git("rev-parse", "HEAD")
    left = git("merge-base", "HEAD", "origin/main")
    written = git("log", "-1", "--format=%H", "--", str(RESULTS.relative_to(ROOT)))
    shallow = git("rev-parse", "--is-shallow-repository") == "true"
    return left if left and left != head else "" if shallow else written


def changed(results: Mapping[str, Result]) -> tuple[list[Mutant], str]:
    """Return the mutants of changed lines, and since when they are; of modules if git does not know."""
    since = base()
    other = [name for name in sorted(results) if results[name].source != hashes_of(name)[0]]
    if not since:
        return [one for name in other for one in mutants(name)], "the last result, by hashes: whole modules"
    found = []
    for name in sorted(results):
        file = str(path_of(name).relative_to(ROOT))
        lines = new_lines(git("diff", "--unified=0", since, "--", file))
        found += [one for one in mutants(name) if one.line in lines]
    return found, since[:12]


def new_lines(difference: str) -> set[int]:
    """Return the numbers of the lines that a difference without context brings."""
    lines: set[int] = set()
    for first, count in re.findall(r"^@@ -\S+ \+(\d+)(?:,(\d+))? @@", difference, flags=re.MULTILINE):
        lines.update(range(int(first), int(first) + int(count or 1)))
    return lines


def drawn(
    every: Iterable[Mutant], results: Mapping[str, Result], seed: int, budget_ms: float
) -> list[Mutant]:
    """Draw modules, and mutants of each, as long as their known cost is within a budget of milliseconds."""

    def place(name: str) -> bytes:
        """Return where a name comes in the order of this seed, on every machine."""
        return hashlib.sha256(f"{seed} {name}".encode()).digest()

    of: dict[str, list[Mutant]] = {}
    for one in every:
        of.setdefault(one.target, []).append(one)
    chosen: list[Mutant] = []
    for name in sorted(of, key=place):
        result = results[name]
        fits = int((budget_ms - result.tests_ms) // max(1, result.mutant_ms))
        mine = sorted(of[name], key=lambda one: place(f"{one.target} {one.node} {one.way}"))
        mine = mine[: min(OF_A_MODULE, max(0, fits))]
        if mine:
            budget_ms -= result.tests_ms + result.mutant_ms * len(mine)
        chosen += mine
    return chosen
