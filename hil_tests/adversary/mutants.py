"""`python -m hil_tests.adversary.mutants -n 30`: which broken bridges does the adversary find, by the truth?

Each mutant of `tools/mutants.py` is loaded in a fork of its own, interpreted, and lives through the same
evenings. It is found where a rule is broken, or where the bridge ends in an exception. One that changes
nothing on the drives' bus in any of them has not reached the plant. One that no unit test can notice is left
out.
"""

# ruff: noqa: T201 - it prints its progress

import argparse
import importlib.abc
import importlib.machinery
import json
import os
import signal
import sys
import time
import tomllib
from collections.abc import Sequence
from pathlib import Path
from types import CodeType, ModuleType
from typing import Any, Final

import numpy as np

ROOT: Final = Path(__file__).parents[2]
TARGETS: Final = (
    "safety/gate",
    "safety/common",
    "safety/limits",
    "safety/tracking",
    "safety/rules",
    "bridge/joint_state",
    "bridge/needs",
    "bridge/orders",
    "bridge/permission",
    "bridge/stops",
    "bridge/power_down",
    "bridge/pipeline",
    "bridge/bridge",
    "canopen_drive/driver/scale",
    "motion/ramp",
    "robots/rars/rules",
    "robots/rars/kinematics",
)
"""Modules between an operator's word and a drive. The guard stands behind them, and hides its own mutants."""
CALM: Final = 1
"""The first seed."""


def tool() -> Any:
    """Return `tools/mutants.py`, which finds its neighbors beside itself."""
    folder = str(ROOT / "tools")
    if folder not in sys.path:
        sys.path.insert(0, folder)
    return importlib.import_module("mutants")


class _Loader(importlib.machinery.SourceFileLoader):
    def __init__(self, name: str, path: str, mutant: Any) -> None:
        super().__init__(name, path)
        self._mutant = mutant

    def get_code(self, fullname: str) -> CodeType:
        del fullname
        return compile(self._mutant.tree(), self.path, "exec")


class _Finder(importlib.abc.MetaPathFinder):
    """Finder of the mutant in the place of its module."""

    def __init__(self, name: str, path: str, mutant: Any) -> None:
        self._name = name
        self._loader = _Loader(name, path, mutant)

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        del path, target
        if fullname != self._name:
            return None
        return importlib.machinery.ModuleSpec(fullname, self._loader, origin=self._loader.path)


def evenings(seconds: float, known: dict[str, str]) -> tuple[str, dict[str, str]]:
    """Execute random runs for so much processor time; return the finding, and the bus traffic of each.

    `known` is their traffic where nothing is broken; empty where that is to be learned. A run with a finding
    where nothing is broken finds nothing.
    """
    # Not before the mutant is in its place.
    from emulators.bench.bench_setup import bench_setup_of  # noqa: PLC0415 - see above
    from emulators.rig import Rig  # noqa: PLC0415 - see above
    from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial  # noqa: PLC0415 - see above
    from firmware_bridge.robot_types import find  # noqa: PLC0415 - see above
    from hil_tests.adversary.failing import FaultProfile  # noqa: PLC0415 - see above
    from hil_tests.adversary.search import Search  # noqa: PLC0415 - see above
    from hil_tests.adversary.truth import invariants  # noqa: PLC0415 - see above

    left: dict[str, str] = {}
    now = [""]

    def seen(rig: Rig) -> None:
        left[now[0]] = json.dumps([wire.frames for wire in rig.can_wires.values()]) + str(
            {name: value for name, value in rig.world.links_sha256.items() if name != "operator"}
        )

    honest, every_profile = frozenset({FaultProfile.HONEST}), frozenset(FaultProfile)
    rars = find("rars")
    line_up = [(rars, every_profile), (rars, honest), (over_serial(rars), every_profile)]
    searches = [
        Search(robot, bench_setup_of(robot), invariants(robot), natures, seen=seen)
        for robot, natures in line_up
    ]
    begun, number = time.process_time(), 0
    while time.process_time() - begun < seconds and (not known or number < len(known)):
        now[0] = str(number)
        found, _ = searches[number % len(searches)].looked(CALM + number)
        left.setdefault(now[0], "")
        if known and found is not None and known.get(now[0]):
            return f"run {number}: {found}", left
        if found is not None:
            left[now[0]] = ""
        number += 1
    return "", left


def forked(seconds: float, known: dict[str, str], mutant: Any = None) -> tuple[str, dict[str, str]]:
    """Do it in a fork, with a mutant in the place of its module; what ends it is found."""
    out, into = os.pipe()
    child = os.fork()
    if not child:
        # A mutant may wait for ever, in its own time.
        signal.setitimer(signal.ITIMER_PROF, 2.0 * seconds + 60.0)
        try:
            if mutant is not None:
                tools = sys.modules["mutants"]
                name, path = tools.module_of(mutant.target), str(tools.path_of(mutant.target))
                sys.meta_path.insert(0, _Finder(name, path, mutant))
            answer: tuple[str, dict[str, str]] = evenings(seconds, known)
        except BaseException as error:  # noqa: BLE001 - a bridge that ends so is found, for any error
            answer = f"{type(error).__name__}: {error}"[:120], {}
        with os.fdopen(into, "w", encoding="utf-8") as pipe:
            json.dump(answer, pipe)
        os._exit(0)
    os.close(into)
    with os.fdopen(out, encoding="utf-8") as pipe:
        text = pipe.read()
    os.waitpid(child, 0)
    if not text:
        return "it does not end", {}
    what, left = json.loads(text)
    return what, left


def main() -> int:
    """Try a sample; print the share."""
    words = argparse.ArgumentParser(prog="mutants", description=__doc__)
    words.add_argument("-n", type=int, default=30, metavar="N", help="how many")
    words.add_argument("--seed", type=int, default=0, help="of the sample")
    words.add_argument("--minutes", type=float, default=10.0, help="of processor time, for each")
    words.add_argument("-k", default="", metavar="TEXT", help="only mutants whose module and line hold this")
    reported = words.parse_args()
    tools = tool()
    rows = tomllib.loads((ROOT / "tools" / "mutate_survivors.toml").read_text(encoding="utf-8"))
    survivors = {(row["module"], row["code"], row["change"]) for row in rows.get("survivor", [])}
    every = [one for target in TARGETS for one in tools.mutants(target) if one.key not in survivors]
    chosen = [one for one in every if reported.k in f"{one.target} {one.code}"]
    places = np.random.default_rng(reported.seed).permutation(len(chosen))[: reported.n]
    chosen = [chosen[int(place)] for place in places]
    seconds = 60.0 * reported.minutes
    _, known = forked(seconds, {})
    print(f"{len(known)} evenings in {seconds:.0f} s of processor time, {len(every)} mutants", flush=True)
    counts = {"found": 0, "missed": 0, "not reached": 0}
    for one in chosen:
        what, left = forked(4.0 * seconds, known, one)
        reached = any(left[key] != known[key] for key in left if known[key])
        verdict = "found" if what else "missed" if reached else "not reached"
        counts[verdict] += 1
        print(f"{verdict}: {one.target}.py:{one.line}: {one.change}: {one.code}: {what}", flush=True)
    reaching = counts["found"] + counts["missed"]
    print(f"{counts}; of {reaching} that reach the plant {counts['found'] / max(1, reaching):.0%} are found")
    return 0


if __name__ == "__main__":
    sys.exit(main())
