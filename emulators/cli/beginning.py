"""What a command says before it runs drives: what makes it wait, and what makes it slow."""

from pathlib import Path
from typing import Final

from emulators.servo.kernel import choose
from firmware_bridge.cli.console import say
from firmware_bridge.robot import AnyRobot
from fmu.build import ensure, is_built
from fmu.plants import names

BUILDING_S: Final = 10
"""How long a plant takes on a machine of today, most of it for SymPy and the compiler."""


def report_beginning(machine: AnyRobot, plant: Path | None) -> None:
    """Build the robot's plant, where that is not done yet, and say so; say when the kernel is not there.

    PlantError where the plant cannot be built; ServoError where a kernel was asked for that is not there.
    """
    reason = choose().reason
    if reason:
        say(f"the drives' loops run in Python, which is slower: {reason}", err=True)
    model = machine.plant.fmu
    if plant is None and model in names() and not is_built(model):
        say(f"building the plant '{model}' (once, about {BUILDING_S} s)", err=True)
        ensure(model)
