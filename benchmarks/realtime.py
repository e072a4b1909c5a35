"""How much faster than real time the mission `circles` runs, and where the time goes.

Usage: python -m benchmarks.realtime [SECONDS]    simulated time; 60 by default.

The factor is that of the fastest of three undisturbed runs; the shares come from a run with stop-watches in
it, which is a little slower. The twin's ratio is that of that mission with the drives' loops in Python.
"""

import os
import sys
import time
from collections.abc import Callable
from typing import Final

import numpy as np

from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import BRIDGE, Rig, build
from emulators.run import HAND_STREAM
from emulators.servo import kernel
from firmware_bridge.robot import find
from firmware_bridge.units import from_seconds

MISSION: Final = "circles"
SEED: Final = 0
RUNS: Final = 3
TWIN_SECONDS: Final = 5.0
LEAST_FACTOR: Final = 10.0


class StopWatch:
    """Adds up the time that calls take."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self.calls = 0

    def around(self, call: Callable[..., object]) -> Callable[..., object]:
        """Return the call with this watch around it."""

        def timed(*arguments: object) -> object:
            begun = time.perf_counter()
            answer = call(*arguments)
            self.seconds += time.perf_counter() - begun
            self.calls += 1
            return answer

        return timed


def rig(servo: str = "") -> Rig:
    """Build the robot with its operator, at the start of the mission."""
    return rig_and_operator(servo)[0]


def rig_and_operator(servo: str = "") -> tuple[Rig, ScriptedOperator]:
    """Build both, for those who ask the operator, too."""
    os.environ[kernel.VARIABLE] = servo
    robot = find("rars")
    script = mission.find(MISSION, robot)
    operator = ScriptedOperator(robot, script, np.random.default_rng([SEED, HAND_STREAM]))
    return build(robot, operator, seed=SEED, noise=script.noise), operator


def wall_seconds(rig: Rig, simulated_s: float) -> float:
    """Run and return the time that it took."""
    begun = time.perf_counter()
    rig.run(from_seconds(simulated_s))
    return time.perf_counter() - begun


def undisturbed(simulated_s: float, servo: str = "", runs: int = RUNS) -> float:
    """Return the shortest time of some runs."""
    times = []
    for _ in range(runs):
        one = rig(servo)
        times.append(wall_seconds(one, simulated_s))
        one.finish()
    return min(times)


def split(simulated_s: float) -> tuple[float, dict[str, StopWatch]]:
    """Return the time of a watched run, and the watches that were in it."""
    watched = rig()
    watches = {name: StopWatch() for name in ("servo and plant", "drives", "bridge", "operator")}
    advance = watches["servo and plant"].around(watched.devices.bank.advance)
    watched.devices.bank.__dict__["advance"] = advance
    for name, station in watched.world._stations.items():  # noqa: SLF001 - a watch must sit where nothing else does
        drive = name in watched.devices.drives
        watch = watches["drives" if drive else "bridge" if name == BRIDGE else "operator"]
        station.receive, station.wake = watch.around(station.receive), watch.around(station.wake)  # type: ignore[assignment] # the watch hands through whatever it is
    total = wall_seconds(watched, simulated_s)
    watched.finish()
    return total, watches


def main(simulated_s: float) -> int:
    """Print the factor and its split; fail where the factor is too small."""
    whole = undisturbed(simulated_s)
    factor = simulated_s / whole
    one = rig()
    native, why_not = one.devices.bank.native, one.devices.bank.why_not_native
    one.finish()
    print(f"{MISSION}, {simulated_s:g} s simulated in {whole:.2f} s: real-time factor {factor:.1f}")
    print(f"  servo: {'kernel in C' if native else f'twin in Python, {why_not}'}")
    total, watches = split(simulated_s)
    rest = total - sum(watch.seconds for watch in watches.values())
    for name, watch in watches.items():
        each = 1e6 * watch.seconds / watch.calls
        print(f"  {name:24s}{100.0 * watch.seconds / total:5.1f} %   {watch.calls} calls of {each:.1f} us")
    print(f"  {'bus, world, samples':24s}{100.0 * rest / total:5.1f} %")
    shortly = min(simulated_s, TWIN_SECONDS)
    ratio = undisturbed(shortly, kernel.TWIN, 1) / undisturbed(shortly)
    print(f"  with the drives' loops in Python: {ratio:.1f} times as long")
    if factor < LEAST_FACTOR:
        print(f"the real-time factor is below {LEAST_FACTOR:g}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
