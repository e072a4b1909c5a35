"""`python -m hil_tests.adversary rars --hours 1`: look for what breaks a rule, as long as wanted.

What is found is shrunk and written as a mission file, which `firmware-bridge bench` drives.
"""

# ruff: noqa: T201 - it prints its progress

import argparse
import sys
from pathlib import Path

import numpy as np

from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.robot import RobotFileError
from hil_tests.adversary.draw import Draw
from hil_tests.adversary.failing import FaultProfile
from hil_tests.adversary.robots import line_of, options, robot_of
from hil_tests.adversary.search import Search, as_toml
from hil_tests.adversary.truth import invariants


def main() -> int:
    """Search; exit status 1 where something was found."""
    words = argparse.ArgumentParser(prog="adversary", description=__doc__)
    options(words)
    words.add_argument("--profiles", nargs="+", choices=[it.value for it in FaultProfile], default=["honest"])
    words.add_argument("--hours", type=float, default=1.0, help="simulated")
    words.add_argument("--seed", type=int, default=0, help="the first one")
    words.add_argument("--out", type=Path, default=Path("out/adversary"))
    reported = words.parse_args()
    try:
        robot = robot_of(reported)
    except RobotFileError as error:
        words.error(str(error))
    profiles = frozenset(map(FaultProfile, reported.profiles))
    line = line_of(reported)
    search = Search(robot, bench_setup_of(robot), invariants(robot), profiles, print)
    driven, seed, count = 0.0, reported.seed, 0
    while driven < 3600.0 * reported.hours:
        found, seconds = search.random_run(seed)
        driven += seconds
        if found is not None:
            count += 1
            reported.out.mkdir(parents=True, exist_ok=True)
            path = reported.out / f"{line.replace(' --', '-').replace(' ', '-')}-{seed}.toml"
            path.write_text(as_toml(found, line), encoding="utf-8")
            print(f"seed {seed}: {found}; {path}")
        seed += 1
    drawn = Draw(robot, bench_setup_of(robot), np.random.default_rng(0), profiles).kinds
    met = search.coverage
    print(f"no fault was on in: {'; '.join(met.never) or 'no joint state left'}")
    seeds = f"seeds {reported.seed} to {seed - 1}"
    print(f"{driven / 3600.0:.2f} simulated hours, {seeds}, {met.share(drawn)}, {count} found")
    return int(count > 0)


if __name__ == "__main__":
    sys.exit(main())
