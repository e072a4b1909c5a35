"""How much faster than real time the mission `circles` runs, and where the time goes.

Usage: realtime.py [SECONDS]    simulated time; 30 by default. The factor is that of an undisturbed run; the
shares come from a second run with stop-watches in it, which is a little slower.
"""

import sys
import time
from collections.abc import Callable
from typing import Final

import numpy as np

from emulators.bench import mission
from emulators.bench.operator import ScriptedOperator
from emulators.rig import Rig, build
from emulators.run import HAND_STREAM
from firmware_bridge.robot import find
from firmware_bridge.units import from_seconds

MISSION: Final = "circles"
SEED: Final = 0
LEAST_FACTOR: Final = 3.0


class StopWatch:
    """Adds up the time that a call takes."""

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


def rig() -> Rig:
    """Build the robot with its operator, at the start of the mission."""
    robot = find("rars")
    script = mission.find(MISSION, robot)
    operator = ScriptedOperator(robot, script, np.random.default_rng([SEED, HAND_STREAM]))
    return build(robot, operator, seed=SEED, noise=script.noise)


def wall_seconds(rig: Rig, simulated_s: float) -> float:
    """Run and return the time that it took."""
    begun = time.perf_counter()
    rig.run(from_seconds(simulated_s))
    return time.perf_counter() - begun


def main(simulated_s: float) -> int:
    """Print the factor and its split; fail where the factor is too small."""
    undisturbed = rig()
    whole = wall_seconds(undisturbed, simulated_s)
    undisturbed.finish()
    factor = simulated_s / whole

    watched = rig()
    plant, physics = StopWatch(), StopWatch()
    bank = watched.devices.bank
    fmu = watched.devices.plant
    fmu.__dict__["step"] = plant.around(fmu.step)
    bank.__dict__["advance"] = physics.around(bank.advance)
    total = wall_seconds(watched, simulated_s)
    watched.finish()

    rows = (
        ("plant (FMU)", plant.seconds, f"{plant.calls} steps"),
        (
            "servo loops of all drives",
            physics.seconds - plant.seconds,
            f"{physics.calls} calls from bus event on",
        ),
        ("bus, drives, bridge, operator", total - physics.seconds, f"{watched.can_wire.frames} frames"),
    )
    print(f"{MISSION}, {simulated_s:g} s simulated in {whole:.2f} s: real-time factor {factor:.2f}")
    for name, seconds, remark in rows:
        print(f"  {name:32s}{100.0 * seconds / total:5.1f} %   {remark}")
    if factor < LEAST_FACTOR:
        print(f"the real-time factor is below {LEAST_FACTOR:g}", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(float(sys.argv[1]) if len(sys.argv) > 1 else 30.0))
