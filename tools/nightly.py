# ruff: noqa: INP001 - a script, not a package
"""Run everything that `.ci/run` leaves out, on one commit, and keep the result of each command.

`python tools/nightly.py [STEP ...]` runs the commands that have not passed on these sources yet, and writes
after each: end it at any time, and it goes on where it was. `--list` shows all commands.
"""

import argparse
import hashlib
import os
import subprocess
import sys
import time
from collections import deque
from collections.abc import Mapping, Sequence
from datetime import UTC, datetime

import nightly_page
from nights import OWN, ROOT, STEPS, Outcome, read, write


def say(text: str) -> None:
    """Show the user at once."""
    sys.stdout.write(f"nightly: {text}\n")
    sys.stdout.flush()


def git(*words: str) -> str:
    """Return what git prints; a failure is an exception."""
    return subprocess.run(["git", *words], cwd=ROOT, capture_output=True, text=True, check=True).stdout  # noqa: S603, S607


def sources() -> str:
    """Return a hash of all files of the newest commit but those that a night writes."""
    files = [line for line in git("ls-tree", "-r", "HEAD").splitlines() if line.split("\t")[1] not in OWN]
    return hashlib.sha256("\n".join(files).encode()).hexdigest()[:12]


def changed() -> list[str]:
    """Return the files that are not as in the newest commit, but those that a night writes."""
    lines = git("status", "--porcelain", "--untracked-files=no").splitlines()
    return [line[3:] for line in lines if line[3:] not in OWN]


def run(command: str) -> tuple[bool, str]:
    """Run a command, its words shown as they come; return whether it passed, and its last words."""
    words: deque[str] = deque(maxlen=40)
    with subprocess.Popen(  # noqa: S602 - the commands are the table's
        command, shell=True, cwd=ROOT, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT
    ) as process:
        assert process.stdout is not None  # noqa: S101 - a pipe was requested
        for line in process.stdout:
            sys.stdout.write(line)
            words.append(line.rstrip())
        sys.stdout.flush()
    return process.returncode == 0, _result(words)


def _result(words: Sequence[str]) -> str:
    """Return pytest's count of tests, all of them where it ran more than once; else the last line."""
    counts = [line.strip("= ") for line in words if " passed" in line or " failed" in line]
    stated = [line for line in words if line.strip()]
    return "; ".join(counts) or (stated[-1] if stated else "")


def work(chosen: Sequence[str], outcomes: dict[str, Outcome]) -> int:
    """Run what has not passed on these sources; return the exit status."""
    commit, source = git("rev-parse", "--short=12", "HEAD").strip(), sources()
    red = []
    for step in STEPS:
        for command in step.commands if not chosen or step.name in chosen else ():
            known = outcomes.get(command)
            if known is not None and known.passed and known.source == source:
                continue
            say(f"{step.name}: {command}")
            begun = time.monotonic()
            passed, result = run(command)
            seconds = round(time.monotonic() - begun)
            on = datetime.now(tz=UTC).date().isoformat()
            outcomes[command] = Outcome(commit, source, on, seconds, passed, result)
            write(outcomes)
            nightly_page.write()
            say(f"{step.name}: {'passed' if passed else 'FAILED'} in {seconds} s: {result}")
            red += [] if passed else [command]
    for command in red:
        say(f"failed: {command}")
    return 1 if red else 0


def listed(outcomes: Mapping[str, Outcome]) -> None:
    """Print all commands, and those that have passed."""
    source = sources()
    for step in STEPS:
        done = [outcomes[it] for it in step.commands if it in outcomes]
        passed = sum(one.passed and one.source == source for one in done)
        say(f"{step.name:12} {passed} of {len(step.commands)} passed on these sources: {step.what}")


def main() -> int:
    """Work until the end, or until someone ends it."""
    parser = argparse.ArgumentParser(description="Run everything that .ci/run leaves out.")
    names = ", ".join(step.name for step in STEPS)
    parser.add_argument("step", nargs="*", help=f"only these, of {names}")
    parser.add_argument("--list", action="store_true", help="say what there is, and run nothing")
    options = parser.parse_args()
    unknown = set(options.step) - {step.name for step in STEPS}
    if unknown:
        parser.error(f"no step {', '.join(sorted(unknown))}; there are {names}")
    outcomes = read()
    if options.list:
        listed(outcomes)
        return 0
    dirty = changed()
    if dirty:
        say(f"commit first, or put away: {', '.join(dirty)}; a result is of a commit")
        return 2
    os.nice(5)
    try:
        return work(options.step, outcomes)
    except KeyboardInterrupt:
        say("ended; what has passed is written, and the next run goes on from there")
        return 130


if __name__ == "__main__":
    sys.exit(main())
