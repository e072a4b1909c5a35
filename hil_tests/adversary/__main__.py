"""`python -m hil_tests.adversary rars --hours 1`: look for what breaks a rule, as long as wanted.

What is found is shrunk and written as a mission file, which `firmware-bridge bench` drives.
"""

# ruff: noqa: T201 - it prints its progress

import argparse
import os
import sys
from pathlib import Path

import numpy as np

from emulators.bench.bench_setup import bench_setup_of
from firmware_bridge.robot import RobotFileError
from hil_tests.adversary.coverage import Coverage
from hil_tests.adversary.draw import Draw
from hil_tests.adversary.failing import FaultProfile
from hil_tests.adversary.robots import line_of, options, robot_of
from hil_tests.adversary.spread_seeds import results


def main() -> int:
    """Search; exit status 1 where something was found."""
    words = argparse.ArgumentParser(prog="adversary", description=__doc__)
    options(words)
    words.add_argument("--profiles", nargs="+", choices=[it.value for it in FaultProfile], default=["honest"])
    words.add_argument("--hours", type=float, default=1.0, help="simulated")
    words.add_argument("--seed", type=int, default=0, help="the first one")
    words.add_argument("--jobs", type=int, default=os.cpu_count() or 1)
    words.add_argument("--out", type=Path, default=Path("out/adversary"))
    reported = words.parse_args()
    try:
        robot = robot_of(reported)
    except RobotFileError as error:
        words.error(str(error))
    line, profiles = line_of(reported), frozenset(reported.profiles)
    coverage, driven, finds, last = Coverage(), 0.0, 0, reported.seed
    # The budget is counted in the seeds' order: what is reported does not depend on the processes.
    for one in results(line, profiles, reported.seed, reported.jobs):
        driven, last = driven + one.seconds, one.seed
        coverage.met.update(one.met)
        if one.found:
            finds += 1
            reported.out.mkdir(parents=True, exist_ok=True)
            path = reported.out / f"{line.replace(' --', '-').replace(' ', '-')}-{one.seed}.toml"
            path.write_text(one.text, encoding="utf-8")
            print(f"seed {one.seed}: {one.found}; {path}", flush=True)
        if driven >= 3600.0 * reported.hours:
            break
    setup = bench_setup_of(robot)
    drawn = Draw(robot, setup, np.random.default_rng(0), frozenset(map(FaultProfile, profiles))).kinds
    print(f"no fault was on in: {'; '.join(coverage.never) or 'no joint state left'}")
    seeds = f"seeds {reported.seed} to {last}"
    print(f"{driven / 3600.0:.2f} simulated hours, {seeds}, {coverage.share(drawn)}, {finds} found")
    return int(finds > 0)


if __name__ == "__main__":
    sys.exit(main())
