"""The golden traces: the first seconds of each shipped mission, as hashes that any machine must reach.

`python tools/golden_traces.py` drives them, prints them as JSON, and names on the standard error whoever ran
the drives' loops; with `--renew` (`make golden`) they are written to `hil_tests/golden/traces.json` instead.
Renew them when a change is meant to change what is on the wires, and say in the commit why.
"""

# ruff: noqa: INP001, T201 - a script, not a package

import json
import sys
from pathlib import Path
from typing import Final, TypeAlias

import numpy as np

from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import build
from emulators.run import HAND_STREAM
from emulators.servo import kernel
from firmware_bridge.robot import find
from firmware_bridge.units import from_seconds
from fmu.build import ensure
from fmu.verify import recorded

Traces: TypeAlias = dict[str, str]
"""SHA-256 by what it is of: `plant NAME`, or `mission NAME`."""

PATH: Final = Path(__file__).parents[1] / "hil_tests" / "golden" / "traces.json"
ROBOT: Final = "rars"
SECONDS: Final = 8.0
"""Set up, armed and under way by then."""
SEED: Final = 1


def missions() -> list[str]:
    """Return the names of the shipped missions."""
    return [path.stem for path in mission.shipped()]


def plant() -> str:
    """Return the fingerprint of the plant: what its equations give without a compiler."""
    carried = recorded(ensure(find(ROBOT).plant.fmu))
    if carried is None:
        raise SystemExit(f"golden_traces: the plant of {ROBOT} carries no fingerprint; build it anew")
    return carried.sha256


def trace(name: str) -> str:
    """Drive the first seconds of a mission; return the hash of every packet on its wires."""
    robot = find(ROBOT)
    script = mission.find(name, robot)
    operator = ScriptedOperator(robot, script, np.random.default_rng([SEED, HAND_STREAM]))
    rig = build(robot, operator, seed=SEED, noise=script.noise, faults=script.fault)
    rig.run(from_seconds(SECONDS))
    rig.finish()
    return rig.world.trace_sha256


def traces() -> Traces:
    """Return all of them as this interpreter, compiler and servo make them."""
    return {f"plant {ROBOT}": plant()} | {f"mission {name}": trace(name) for name in missions()}


def golden() -> Traces:
    """Return those that are kept."""
    kept: Traces = json.loads(PATH.read_text(encoding="utf-8"))
    return kept


def main() -> None:
    """Print or renew them."""
    text = json.dumps(traces(), indent=2) + "\n"
    if "--renew" in sys.argv[1:]:
        PATH.write_text(text, encoding="utf-8")
        return
    print("kernel" if kernel.choose().library is not None else "twin", file=sys.stderr)
    print(text, end="")


if __name__ == "__main__":
    main()
