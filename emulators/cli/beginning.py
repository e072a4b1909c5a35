"""Messages of a command before it runs drives: the reasons to wait, and those to be slow."""

from pathlib import Path
from typing import Final

from emulators.servo.kernel import choose
from firmware_bridge.cli.console import say
from firmware_bridge.robot import AnyRobot
from fmu.build import ensure, is_built
from fmu.plants import names

BUILDING_S: Final = 10
"""Time to build a plant on a machine of today, most of it for SymPy and the compiler."""


def report_beginning(machine: AnyRobot, plant: Path | None) -> None:
    """Build the robot's plant, where that is not done yet, and report it; report a missing kernel.

    PlantError where the plant cannot be built; ServoError where a requested kernel is missing.
    """
    reason = choose().reason
    if reason:
        say(f"the drives' loops run in Python, which is slower: {reason}", err=True)
    model = machine.plant.fmu
    if plant is None and model in names() and not is_built(model):
        say(f"building the plant '{model}' (once, about {BUILDING_S} s)", err=True)
        ensure(model)
