"""ROME's base over its emulated board: four firmwares drive it; whatever the board does ends in a stand."""

import math
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Final

import numpy as np
import pytest

from emulators.bench import mission as missions
from emulators.bench.operator import ScriptedOperator
from emulators.bench.path_error import Followed, path_error
from emulators.bench.rehearsal import rehearsal_of
from emulators.rig import BRIDGE, Rig
from firmware_bridge.drivers.shield.fleet import over_protocol
from firmware_bridge.kinds import find

FULL: Final = {"ros-arduino-bridge": 3, "arduinoio": 3, "mw": 3, "firmata": 2}
STANDS_MPS: Final = 0.005
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
    """A rig on which the operator arms, and says one thing after it."""
    robot = over_protocol(find("rome"), protocol, encoders)
    rehearsal = rehearsal_of(robot)
    text = AHEAD.format(duration=duration, faults=faults, title="go", word=word)
    script = missions.parse(text, "story.toml", robot, rehearsal)
    operator = ScriptedOperator(robot, rehearsal, script, np.random.default_rng(0))
    rig = Rig(robot, rehearsal, operator, faults=script.fault)
    try:
        yield rig
    finally:
        rig.finish()


def speed(rig: Rig) -> float:
    """How fast the base is, m/s."""
    row = rig.samples[-1]
    return math.hypot(row["speed_mps"], row["speed_left_mps"])


def held(rig: Rig) -> set[str]:
    """The interlocks that have held so far."""
    return {record.name for record in rig.holds}


@pytest.mark.parametrize("protocol", FULL)
def test_each_firmware_drives_the_circle_and_the_guard_has_nothing_to_refuse(protocol: str) -> None:
    with driven(protocol, 'guide = "circle"', 12.0, encoders=FULL[protocol]) as rig:
        rig.runs(9.5)
        assert rig.guard.refused == 0, rig.guard.refusals
        path = rehearsal_of(rig.robot).paths["circle"](rig.robot)
        error = path_error(rig.samples, [Followed(4.5, path)], 2.5)
        assert error.same_instant is not None
        assert error.same_instant < (0.02 if FULL[protocol] == 3 else 0.08)
        assert speed(rig) == pytest.approx(0.25, abs=0.04)
        rig.world.stop(BRIDGE)
        rig.runs(4.0)
        assert rig.bridge.finished
        assert rig.bridge.unconfirmed == ()
        assert not any(axis.powered for axis in rig.devices.bank.axes)
        assert speed(rig) < STANDS_MPS


@pytest.mark.parametrize(
    ("protocol", "runs_on_m"),
    [("ros-arduino-bridge", 0.7), ("arduinoio", 0.7), ("mw", 0.9), ("firmata", 1.6)],
)
def test_a_board_that_starts_anew_in_mid_motion_ends_in_a_stand(protocol: str, runs_on_m: float) -> None:
    """The shield is not reset with it, and goes on as it was told; to set it up releases the motors first.

    MWProtocol's board answers some milliseconds after its release was given up: it is reset, and boots twice.
    """
    fault = '[[fault]]\nkind = "board_reset"\nat_s = 6.5\n'
    with driven(protocol, "speed_mps = 0.3", 20.0, fault, FULL[protocol]) as rig:
        rig.runs(6.5)
        assert speed(rig) == pytest.approx(0.3, abs=0.05)
        before = rig.samples[-1]["x_m"]
        rig.runs(6.5)
        assert speed(rig) < STANDS_MPS
        assert rig.samples[-1]["x_m"] - before < runs_on_m
        assert {"axis answers late: one", "axis silent: one"} <= held(rig)
        assert not rig.bridge.seen.facts.armed
        assert not any(axis.powered for axis in rig.devices.bank.axes)


@pytest.mark.parametrize(("protocol", "stops"), [("ros-arduino-bridge", True), ("arduinoio", False)])
def test_a_board_that_nobody_reaches_stops_where_its_firmware_does(protocol: str, *, stops: bool) -> None:
    """The stock auto-stop is of 2 s; without one the motors run on until the line is back: then they stop."""
    fault = '[[fault]]\nkind = "board_silent"\nat_s = 6.5\nfor_s = 3.5\n'
    with driven(protocol, "speed_mps = 0.3", 20.0, fault, FULL[protocol]) as rig:
        rig.runs(9.9)
        assert (speed(rig) < STANDS_MPS) is stops
        assert {"axis silent: one", "speed 0 unconfirmed: one"} <= held(rig)
        rig.runs(2.5)
        assert speed(rig) < STANDS_MPS
        assert not any(axis.powered for axis in rig.devices.bank.axes)


@pytest.mark.parametrize(
    ("fault", "holds"),
    [
        ("encoder_cable_off", {"axis does not follow: two", "axis position repeats: two"}),
        ("motor_cable_off", {"axis does not follow: two"}),
    ],
)
def test_a_wire_that_is_off_is_named_and_the_base_stops(fault: str, holds: set[str]) -> None:
    text = f'[[fault]]\nkind = "{fault}"\nnode = "two"\nat_s = 6.5\n'
    with driven("ros-arduino-bridge", "speed_mps = 0.3", 20.0, text) as rig:
        rig.runs(9.0)
        assert holds <= held(rig)
        assert speed(rig) < STANDS_MPS
        assert not rig.bridge.seen.facts.armed
