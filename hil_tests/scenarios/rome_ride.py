"""ROME's base on the bench with one thing to do: its operator arms, and sends one command."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

from emulators.rig import Rig
from emulators.testing.inherited.scripted import scripted
from firmware_bridge.families.motor_shield.driver.link_drivers import over_protocol
from firmware_bridge.robot_types import find

FULL: Final = {"ros-arduino-bridge": 3, "arduinoio": 3, "mw": 3, "firmata": 2}
STANDSTILL_MPS: Final = 0.005
AHEAD: Final = """
title = "ahead"
duration_s = {duration}
input = "twist"
{faults}
[[step]]
at_s = 4.0
title = "arm"
arm = true
[[step]]
at_s = 4.5
title = "{title}"
{word}
"""


@contextmanager
def driven(
    protocol: str, word: str, duration: float, faults: str = "", encoders: int | None = None
) -> Iterator[Rig]:
    """Yield a rig on which the operator arms, and sends one command after it."""
    text = AHEAD.format(duration=duration, faults=faults, title="go", word=word)
    with scripted(over_protocol(find("rome"), protocol, encoders), text) as rig:
        yield rig


def speed(rig: Rig) -> float:
    """Return the speed of the base, m/s."""
    row = rig.samples[-1]
    return math.hypot(row["speed_mps"], row["speed_left_mps"])


def held(rig: Rig) -> set[str]:
    """The interlocks that have held so far."""
    return {record.name for record in rig.interlock_events}
