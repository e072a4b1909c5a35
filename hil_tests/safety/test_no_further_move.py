"""After an order to stop no further move leaves for an arm of steppers, whatever instant it comes in."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

import pytest

from emulators.rig import BRIDGE
from emulators.testing.rig import VirtualRig
from firmware_bridge.packet import Packet
from hil_tests.rows import every
from hil_tests.safety.driving import ORDERS, changed, robot_of

MOVE: Final = b"MJ"
PHASES: Final = tuple(0.0237 * place for place in range(5))
"""s: over more than a cycle of the arm."""
DOES: Final[dict[str, dict[str, Any]]] = {
    "ar2": {"input": "twist", "speed_mps": 0.02},
    "rome_arm": {"up_mps": 0.02},
}
STOPS: Final = ORDERS | {"disarm": lambda rig: rig.operator.disarms()}


@contextmanager
def moves_of(rig: VirtualRig) -> Iterator[list[int]]:
    """Collect when the bridge sends a move."""
    sent = list[int]()

    def noted(packet: Packet) -> tuple[Packet, ...]:
        if packet.payload.startswith(MOVE):
            sent.append(rig.bench.world.now)
        return (packet,)

    with changed(rig, BRIDGE, noted):
        yield sent


@pytest.mark.long(keeps=["ar2"])
@pytest.mark.parametrize("robot", DOES)
@every("order", STOPS.items(), ids=lambda it: it[0])
def test_no_move_leaves_after_it(robot: str, order: tuple[str, object]) -> None:
    rig = VirtualRig(robot_of(robot))
    rig.arms()
    rig.operator.does(**DOES[robot])
    rig.runs(2.5)
    for phase in PHASES:
        with rig.branch(), moves_of(rig) as sent:
            rig.runs(0.15 + phase)
            before = len(sent)
            assert before, "it moves"
            STOPS[order[0]](rig)
            while rig.bench.bridge._permission.armed:  # noqa: SLF001 - the instant in which it is accepted
                rig.runs(0.001)
            answered = rig.bench.world.now
            rig.runs(1.0)
            assert [at for at in sent if at > answered] == []
