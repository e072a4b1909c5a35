"""Speed of the mission `circles` against real time, and the shares of that time.

Usage: python -m benchmarks.realtime [SECONDS]    simulated time; 60 by default.

All times are the processor's, so that other work on the machine counts less. The factor is that of the
fastest of three undisturbed runs. The shares come from a run with stop-watches in it, which is slower: one
around each node, and one around the physics; bus, links and world have what is left. The plant's share is
what the ticks of that run cost a plant alone, with its inputs at rest; the kernel's is the rest of its calls.
The ratios are those of that mission with the core interpreted, and with the drives' loops in Python.
"""

import os
import subprocess
import sys
import time
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np

from emulators import world
from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import BRIDGE, OPERATOR_STATION, Rig
from emulators.robots.rars import BENCH_SETUP
from emulators.run import HAND_STREAM
from emulators.servo import kernel
from emulators.servo.axis import TICK
from emulators.servo.bank import ServoBank
from emulators.world import Physics
from firmware_bridge.robot_types import find
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds

MISSION: Final = "circles"
SEED: Final = 0
RUNS: Final = 3
COMPILED: Final = not str(world.__file__).endswith(".py")
REFERENCE_SECONDS: Final = 5.0
LEAST_FACTOR: Final = 10.0
ALONE: Final[Nanoseconds] = 2 * SECOND
"""Time for which the plant runs alone, to measure the cost of a tick."""


class StopWatches:
    """Adds up the time that each part takes; no part calls another."""

    def __init__(self) -> None:
        self.seconds: dict[str, float] = {}
        self.calls: dict[str, int] = {}

    def around(self, part: str, call: Callable[..., object]) -> Callable[..., object]:
        """Return the call with the watch of this part around it."""
        seconds, calls = self.seconds, self.calls
        seconds.setdefault(part, 0.0)
        calls.setdefault(part, 0)

        def timed(*arguments: object) -> object:
            begun = time.process_time()
            result = call(*arguments)
            seconds[part] += time.process_time() - begun
            calls[part] += 1
            return result

        return timed


def rig(servo: str = "") -> Rig:
    """Build the robot with its operator, at the start of the mission."""
    return rig_and_operator(servo)[0]


def rig_and_operator(servo: str = "") -> tuple[Rig, ScriptedOperator]:
    """Build both, for those who ask the operator, too."""
    os.environ[kernel.VARIABLE] = servo
    robot = find("rars")
    script = mission.find(MISSION, robot, BENCH_SETUP)
    operator = ScriptedOperator(robot, BENCH_SETUP, script, np.random.default_rng([SEED, HAND_STREAM]))
    return Rig(robot, BENCH_SETUP, operator, seed=SEED, noise=script.noise), operator


def seconds_of(call: Callable[[], object]) -> float:
    """Call, and return the processor's time that it took."""
    begun = time.process_time()
    call()
    return time.process_time() - begun


def undisturbed(simulated_s: float, servo: str = "", runs: int = RUNS) -> float:
    """Return the shortest time of some runs."""
    times = []
    for _ in range(runs):
        one = rig(servo)
        times.append(seconds_of(lambda one=one: one.run(from_seconds(simulated_s))))  # type: ignore[misc] # bound now
        one.finish()
    return min(times)


def plant_seconds_per_tick() -> float:
    """Return what the plant costs in one tick of the kernel: its step without any drive above it."""
    one = rig()
    bank = ServoBank(one.devices.plant, (), supply=None)
    taken = min(seconds_of(lambda k=k: bank.advance(k * ALONE)) for k in range(1, RUNS + 1))  # type: ignore[misc] # bound now
    one.finish()
    return taken * TICK / ALONE


class Watched:
    """The physics with a watch around it."""

    def __init__(self, physics: Physics, watches: StopWatches) -> None:
        self.advance = watches.around("servo", physics.advance)


def split(watched: Rig, simulated_s: float, parts: Mapping[str, str]) -> tuple[float, StopWatches]:
    """Return the seconds of a watched run, and its watches: one for each part, by the nodes' names."""
    watches = StopWatches()
    inner: Any = watched.world
    inner._physics = Watched(inner._physics, watches)  # noqa: SLF001 - a watch must sit where nothing else does
    for name, station in inner._stations.items():  # noqa: SLF001
        for call in ("receive", "wake"):
            setattr(station, call, watches.around(parts.get(name, "drives"), getattr(station, call)))
    return seconds_of(lambda: watched.run(from_seconds(simulated_s))), watches


Rows = dict[str, tuple[float, int, str]]


def rows_of(whole: float, watches: StopWatches, simulated_s: float) -> Rows:
    """Return seconds, count and unit of each part, and of what has no watch."""
    rows = {part: (taken, watches.calls[part], "calls") for part, taken in watches.seconds.items()}
    rows["bus, links and world"] = (whole - sum(watches.seconds.values()), round(simulated_s * 1000), "ms")
    return rows


def print_rows(whole: float, rows: Rows) -> None:
    """Print one row for each part, the largest first."""
    for part, (taken, count, unit) in sorted(rows.items(), key=lambda row: -row[1][0]):
        each = 1e6 * taken / max(count, 1)
        print(f"  {part:24s}{100.0 * taken / whole:5.1f} %   {count} {unit} of {each:.2f} us")


def print_split(simulated_s: float) -> None:
    """Print where the time goes, the plant's share of the physics by itself."""
    watched = rig()
    whole, watches = split(watched, simulated_s, {BRIDGE: "bridge", OPERATOR_STATION: "operator"})
    watched.finish()
    ticks = round(from_seconds(simulated_s) / TICK)
    plant = min(plant_seconds_per_tick() * ticks, watches.seconds["servo"])
    rows = rows_of(whole, watches, simulated_s)
    rows["plant"] = (plant, ticks, "ticks")
    rows["servo kernel"] = (rows.pop("servo")[0] - plant, ticks, "ticks")
    print_rows(whole, rows)


def interpreted(simulated_s: float) -> float:
    """Return the time of the same runs by the same Python, with the core as it stands in this checkout."""
    checkout = Path(__file__).parents[1]
    words = [sys.executable, "-c", f"from benchmarks.realtime import *; print(undisturbed({simulated_s}))"]
    reported = subprocess.run(  # noqa: S603 - this file, by this interpreter
        words, env=os.environ | {"PYTHONPATH": str(checkout)}, capture_output=True, text=True, check=True
    )
    return float(reported.stdout)


def main(simulated_s: float) -> int:
    """Print the factor and its split; fail where the factor is too small."""
    whole = undisturbed(simulated_s)
    factor = simulated_s / whole
    one = rig()
    (bank,) = (it for it in one.devices.actuated.actuators if isinstance(it, ServoBank))
    native, why_not = bank.native, bank.why_not_native
    one.finish()
    print(f"{MISSION}, {simulated_s:g} s simulated in {whole:.2f} s: real-time factor {factor:.1f}")
    print(f"  core: {'compiled' if COMPILED else 'interpreted; `make compiled` translates it to C'}")
    print(f"  servo: {'kernel in C' if native else f'reference in Python, {why_not}'}")
    print_split(simulated_s)
    if COMPILED:
        print(f"  with the core interpreted: {interpreted(simulated_s) / whole:.2f} times as long")
    shortly = min(simulated_s, REFERENCE_SECONDS)
    ratio = undisturbed(shortly, kernel.REFERENCE, 1) / undisturbed(shortly)
    print(f"  with the drives' loops in Python: {ratio:.1f} times as long")
    if factor < LEAST_FACTOR:
        print(f"the real-time factor is below {LEAST_FACTOR:g}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0))
