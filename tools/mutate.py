# ruff: noqa: INP001 - a script, not a package
"""Mutation campaign: break the program in one place at a time; its tests must notice every time.

`python tools/mutate.py [-j N] [-k TEXT] [MODULE ...]` runs what is not up to date, module by module, and
writes after each what it has found: end it at any time, and it goes on where it was. `--all` begins again.
With `-k` only mutants whose module and line hold the text are run, and nothing is written. `--report` runs
nothing. `--ci` runs the mutants of changed lines, and a sample. It exits with 1 when one survives in safety
or motion that has no reason; with `--ci` or `-k`, when one survives that is not known.
"""

import argparse
import os
import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from fnmatch import fnmatch
from itertools import groupby
from typing import Final

from campaign import Reach, Unsound, reach_of, tried
from mutants import Key, Mutant, mutants
from packages import hashes_of, named_for, targets, tests_of
from results import Result, read_reasons, read_results, write_results
from sample import changed, drawn, seed_of

JUDGED: Final = ("safety/*", "motion/*", "families/*/guard*", "robots/ar2/arm")
"""Modules in which every survivor has its reason; those of the others are listed."""


def say(text: str) -> None:
    """Inform the user at once."""
    sys.stdout.write(f"{text}\n")
    sys.stdout.flush()


class Runs:
    """Runs of modules, one after the other; the tests' reach is found once for all that share them."""

    def __init__(self, every: Sequence[str], jobs: int) -> None:
        self._every = every
        self._jobs = jobs
        self._files: Sequence[object] = ()
        self._reach = Reach()

    def __call__(self, chosen: Sequence[Mutant]) -> tuple[list[Mutant], Reach, float]:
        """Return who survived of one module's mutants, what its tests reach, and the processor's seconds."""
        target = chosen[0].target
        files = tests_of(target)
        if files != self._files:
            mine = [one for one in self._every if tests_of(one) == files]
            self._reach = reach_of(mine, files, named_for(target))
            self._files = files
        begun = time.monotonic()
        alive, seconds = tried(chosen, self._reach, self._jobs)
        say(
            f"{target}: {len(chosen)} mutants, {len(alive)} survived, "
            f"{seconds:.0f} s of processor time, {time.monotonic() - begun:.0f} s"
        )
        return alive, self._reach, seconds


def campaign(chosen: Sequence[str], run: Runs, results: dict[str, Result], *, again: bool) -> None:
    """Run the modules that are not up to date, and write after each."""
    for target in chosen:
        hashes = hashes_of(target)
        if not again and target in results and results[target].ran_on(hashes):
            continue
        mine = list(mutants(target))
        alive, reach, seconds = run(mine)
        if hashes_of(target) != hashes:
            say(f"{target}, or its tests, changed meanwhile: worth nothing, and not written")
            continue
        results[target] = Result(
            *hashes,
            len(mine),
            _rounded(reach.cost_s * 1e3),
            _rounded(seconds * 1e3 / len(mine)),
            tuple((one.code, one.change) for one in alive),
        )
        write_results(results)


def _rounded(milliseconds: float) -> int:
    """Return one digit and a half, so that a file does not change with each run."""
    step = 10 ** max(0, len(str(int(milliseconds))) - 2) * 5
    return max(1, round(milliseconds / step)) * step


def report(every: Sequence[str], results: Mapping[str, Result], reasons: Mapping[Key, str]) -> int:
    """Print the results of each package; return the number of mutants that survive without a reason."""
    packages: dict[str, list[int]] = defaultdict(lambda: [0] * 5)
    stale = []
    for target in every:
        package = packages[target.rpartition("/")[0]]
        result = results.get(target)
        if result is None:
            package[4] += sum(1 for _ in mutants(target))
            say(f"open, never completed: {target}")
            continue
        if not result.ran_on(hashes_of(target)):
            stale.append(target)
        named = sum((target, *one) in reasons for one in result.survived)
        package[0] += result.mutants
        package[1] += result.mutants - len(result.survived)
        package[2] += named
        package[3] += len(result.survived) - named
    say(f"{'package':28}{'mutants':>9}{'noticed':>9}{'equivalent':>12}{'open':>7}{'never run':>11}")
    packages["all"] = [sum(column) for column in zip(*packages.values(), strict=True)]
    for name, (tried_, noticed, named, left, never) in packages.items():
        say(f"{name:28}{tried_:>9}{noticed:>9}{named:>12}{left:>7}{never:>11}")
    if stale:
        say(f"not of these sources any more: {', '.join(stale)}")
    return packages["all"][3]


def complaints(alive: Iterable[Key], known: Iterable[Key]) -> list[str]:
    """Name the survivors that no one knows."""
    kept = set(known)
    return [f"survived: {key[0]}.py: {key[2]}: {key[1]}" for key in alive if key not in kept]


def superfluous(results: Mapping[str, Result], reasons: Mapping[Key, str]) -> list[str]:
    """Name the reasons whose mutant did not survive its module's last campaign."""
    alive = {(name, *one) for name, result in results.items() for one in result.survived}
    return [
        f"listed, but did not survive: {key[0]}.py: {key[2]}: {key[1]}"
        for key in reasons
        if key[0] in results and key not in alive
    ]


def ci(run: Runs, results: Mapping[str, Result], known: Iterable[Key], seed: int, minutes: float) -> int:
    """Run the mutants of changed lines, and a sample of all others; return the exit status."""
    say(f"seed {seed}; modules whose campaign was never completed are left out of both")
    budget = minutes * 60_000
    lines, since = changed(results)
    say(f"changed lines since {since}: {len(lines)} mutants")
    chosen = drawn(lines, results, seed, budget)
    if len(chosen) < len(lines):
        say(f"of these {len(chosen)} are run: there is time for no more")
    left = budget - sum(results[one.target].mutant_ms for one in chosen)
    others = [one for name in sorted(results) for one in mutants(name)]
    chosen = list(dict.fromkeys((*chosen, *drawn(others, results, seed, left))))
    chosen.sort(key=lambda one: (tests_of(one.target), one.target, one.node, one.way))
    alive = []
    for _, mine in groupby(chosen, key=lambda one: one.target):
        alive += run(list(mine))[0]
    bad = complaints([one.key for one in alive], known)
    for complaint in bad:
        say(complaint)
    say(f"{len(chosen)} mutants: {len(chosen) - len(alive)} noticed, {len(alive) - len(bad)} known survivors")
    return 1 if bad else 0


def some(chosen: Sequence[str], run: Runs, reasons: Iterable[Key], text: str) -> list[str]:
    """Run the mutants whose module and line hold a text; name those that survive without a reason."""
    alive: list[Mutant] = []
    for target in chosen:
        mine = [one for one in mutants(target) if text in f"{one.target} {one.code}"]
        alive += run(mine)[0] if mine else []
    return complaints([one.key for one in alive], reasons)


def options_of() -> argparse.Namespace:
    """Return the options of the command line."""
    parser = argparse.ArgumentParser(description="Break the program in one place at a time.")
    parser.add_argument("module", nargs="*", default=["*"], help="only these, for instance 'safety/*'")
    parser.add_argument("-j", type=int, default=os.cpu_count() or 1, metavar="N", help="runs at a time")
    parser.add_argument("-k", default="", metavar="TEXT", help="only mutants whose module and line hold this")
    parser.add_argument("--all", action="store_true", help="what is up to date, too")
    parser.add_argument("--report", action="store_true", help="say what is known")
    parser.add_argument("--ci", action="store_true", help="changed lines, and a sample")
    parser.add_argument("--seed", type=int, help="of the sample; without it, from the newest commit")
    parser.add_argument("--minutes", type=float, default=10.0, help="of processor time, by what is known")
    return parser.parse_args()


def work(options: argparse.Namespace) -> int:
    """Run the requested modules, and report the results; return the exit status."""
    every = list(targets())
    chosen = [one for one in every if any(fnmatch(one, it) for it in options.module)]
    results = {name: result for name, result in read_results().items() if name in every}
    reasons, run = read_reasons(), Runs(every, options.j)
    known = {*reasons, *((name, *one) for name, result in results.items() for one in result.survived)}
    if options.ci:
        seed = seed_of() if options.seed is None else options.seed
        return ci(run, results, known, seed, options.minutes)
    if options.k:
        bad = some(chosen, run, reasons, options.k)
    else:
        if not options.report:
            campaign(chosen, run, results, again=options.all)
        found = [(name, *one) for name, result in results.items() for one in result.survived]
        judged = [key for key in found if any(fnmatch(key[0], pattern) for pattern in JUDGED)]
        bad = [*complaints(judged, reasons), *superfluous(results, reasons)]
        report(every, results, reasons)
    for complaint in bad:
        say(complaint)
    return 1 if bad else 0


def main() -> int:
    """Work until the end, or until someone ends it."""
    options = options_of()
    try:
        # A mutant's process ends without tidying up.
        with tempfile.TemporaryDirectory(prefix="mutants-") as folder:
            tempfile.tempdir = os.environ["TMPDIR"] = folder
            return work(options)
    except Unsound as problem:
        say(f"worth nothing: {problem}")
        return 1
    except (KeyboardInterrupt, EOFError):
        say("ended; what was completed is written, and the next run goes on from there")
        return 130


if __name__ == "__main__":
    sys.exit(main())
