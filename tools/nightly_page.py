# ruff: noqa: INP001 - a script's neighbor, not a package
"""`docs/nightly.md`: the results of the nightly commands, and of the mutation campaign by package."""

from collections import defaultdict
from collections.abc import Iterator, Sequence
from typing import Final

from mutants import mutants
from nights import ROOT, STEPS, Outcome, Step
from nights import read as read_outcomes
from packages import targets
from results import read_reasons, read_results

PAGE: Final = ROOT / "docs" / "nightly.md"
HEAD: Final = """\
# Nightly tests

`.ci/run` checks each change in less than a quarter of an hour. `make nightly` runs the remaining tests: hours
of processor time, step by step. An interrupted run continues where it was; a command that has passed on the
same sources is not repeated. `.ci/packages nightly` installs the required packages on Debian. The table lists
the result and the commit of each step; `tools/nightly.py` writes it.
"""
MUTATION: Final = """
## Mutation, by package

The program is changed in one place at a time ([method](decisions/test-methods.md#mutation-testing)); a test
has to fail. *Known* mutants are equivalent to the original, each with its reason in
`tools/mutate_survivors.toml`; *alive* mutants are not detected by any test and not explained. In `safety` and
`motion` such a mutant fails the step; those of the other packages are listed in `tools/mutate_results.toml`.
"""


def write() -> None:
    """Write the page."""
    text = "".join((HEAD, "\n", *_table(list(_steps())), MUTATION, "\n", *_table(list(_packages()))))
    PAGE.write_text(text, encoding="utf-8")


def _table(rows: Sequence[Sequence[object]]) -> Iterator[str]:
    for place, row in enumerate(rows):
        yield f"| {' | '.join(map(str, row))} |\n"
        if place == 0:
            yield f"|{'---|' * len(row)}\n"


def _steps() -> Iterator[Sequence[object]]:
    outcomes = read_outcomes()
    yield "step", "description", "commands passed", "on", "commit", "minutes", "result"
    for step in STEPS:
        done = [outcomes[command] for command in step.commands if command in outcomes]
        yield step.name, step.what, *_outcome(step, done)


def _outcome(step: Step, done: Sequence[Outcome]) -> Sequence[object]:
    passed = f"{sum(one.passed for one in done)} of {len(step.commands)}"
    if not done:
        return passed, "-", "-", "-", "never run"
    commits = ", ".join(f"`{commit}`" for commit in sorted({one.commit for one in done}))
    results = [one.result if one.passed else f"**failed**: {one.result}" for one in done]
    minutes = round(sum(one.seconds for one in done) / 60)
    return passed, max(one.on for one in done), commits, minutes, "; ".join(dict.fromkeys(results))


def _packages() -> Iterator[Sequence[object]]:
    yield "package", "mutants", "run", "killed", "known", "alive"
    results, reasons = read_results(), read_reasons()
    packages: dict[str, list[int]] = defaultdict(lambda: [0] * 5)
    for target in targets():
        row = packages["/".join(target.split("/")[:-1][:2])]
        result = results.get(target)
        if result is None:
            row[0] += sum(1 for _ in mutants(target))
            continue
        named = sum((target, *one) in reasons for one in result.survived)
        alive = len(result.survived)
        counts = (result.mutants, result.mutants, result.mutants - alive, named, alive - named)
        for place, count in enumerate(counts):
            row[place] += count
    packages["**all**"] = [sum(column) for column in zip(*packages.values(), strict=True)]
    for name, row in packages.items():
        yield (name, *row)
