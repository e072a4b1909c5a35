"""Each fault of a random run, then an order to stop: the robot stands, and the end comes."""

from collections.abc import Iterator
from contextlib import suppress
from typing import Any, Final

import numpy as np
import pytest

from emulators.testing.errors import RigError
from emulators.testing.rig import VirtualRig
from firmware_bridge.bridge.stops import Progress
from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN
from firmware_bridge.runtime.runner import STOP_WITHIN
from firmware_bridge.units import to_seconds
from hil_tests.adversary.failing import FAILING
from hil_tests.rows import every
from hil_tests.safety.driving import ARM, ORDERS, driving, runs, speed

OTHERS: Final = {
    "bridge_ends", "bridge_suspended", "second_bridge", "second_station", "datagram_loss", "datagram_late",
    "datagram_doubled", "nmt_foreign_node", "stray_frames",
}  # fmt: skip
"""Faults that are not the robot's: they end the bridge, or send in the operator's name."""
KINDS: Final = sorted(FAILING.keys() - OTHERS)
BEYOND_REACH: Final = {"rome:mw:3": {"serial_unplugged"}, ARM: {"serial_unplugged"}}
"""Faults by which nothing reaches the board: without a watchdog it drives on; an arm ends its move."""
OF_ONE: Final = {"rome:mw:3": "two"}
"""Axis of a fault of one axis; else it is the left wheel."""


def faults(rig: VirtualRig, kind: str) -> None:
    """Let it happen; RigError where this robot has no such fault."""
    how: dict[str, Any] = FAILING[kind].how(np.random.default_rng(3))
    try:
        rig.fault(kind, node=OF_ONE.get(rig.robot.name, "left"), **how)
    except RigError:
        rig.fault(kind, **how)


def reported(robot: str) -> Iterator[str]:
    """Yield the faults that a robot may have."""
    for kind in sorted(set(KINDS) - BEYOND_REACH.get(robot, set())):
        with driving(robot) as rig, suppress(RigError):
            faults(rig, kind)
            yield kind


@pytest.mark.long(beside="test_whatever_a_board_and_its_line_do_each_stage_lasts_what_its_row_states")
@pytest.mark.parametrize("robot", ["rars", "rars+serial", "climber", "rome:mw:3", ARM])
def test_it_stands_in_time_and_the_end_comes(robot: str) -> None:
    kinds = tuple(reported(robot))
    assert len(kinds) > 3

    @every("kind", kinds)
    @every("order", ORDERS)
    def stands(kind: str, order: str) -> None:
        with driving(robot) as rig:
            faults(rig, kind)
            runs(rig, 0.3)
            ORDERS[order](rig)
            moved = runs(rig, to_seconds(STOP_WITHIN))
            given_up = any(stop.progress is Progress.GIVEN_UP for stop in rig.bench.bridge.stops.values())
            assert moved <= to_seconds(TAKEN_WITHIN) + 1.0 or given_up or rig.bench.bridge.not_acknowledged
            assert speed(rig) < 0.01 or given_up or rig.bench.bridge.not_acknowledged
            assert order != "Ctrl-C" or rig.bench.bridge.finished or rig.bench.bridge.holding

    stands()
