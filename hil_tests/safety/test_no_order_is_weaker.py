"""No order to stop is slower than a weaker one, for any behavior or report of the drive meanwhile."""

import struct
from collections.abc import Callable
from contextlib import ExitStack
from typing import Final

import pytest

from emulators.testing.rig import STEP_S, VirtualRig
from firmware_bridge.packet import Packet
from firmware_bridge.units import to_seconds
from hil_tests.rows import every
from hil_tests.safety.driving import ORDERS, SAMPLE, changed, driving, robot_of, runs, with_payload

SDO_ANSWER: Final = 0x580
NODE: Final = 1
WEAKEST: Final[Callable[[VirtualRig], None]] = lambda rig: rig.operator.returns_to_neutral()  # noqa: E731 - as ORDERS
STRONGER: Final = ("emergency stop", "forced disarm")


def states(statusword: int, every_nth: int = 1) -> Callable[[Packet], tuple[Packet, ...]]:
    """Return the change that makes each so-manieth sample of a drive report a state."""
    count = 0

    def change(packet: Packet) -> tuple[Packet, ...]:
        nonlocal count
        if packet.address != SAMPLE + NODE:
            return (packet,)
        count += 1
        if count % every_nth:
            return (packet,)
        return (with_payload(packet, struct.pack("<H", statusword) + packet.payload[2:]),)

    return change


def answers_each_third() -> Callable[[Packet], tuple[Packet, ...]]:
    """Return what loses two of three SDO answers."""
    count = 0

    def change(packet: Packet) -> tuple[Packet, ...]:
        nonlocal count
        if packet.address != SDO_ANSWER + NODE:
            return (packet,)
        count += 1
        return () if count % 3 else (packet,)

    return change


LIES: Final = {
    "reports the truth": lambda: lambda packet: (packet,),
    "reports it is off": lambda: states(0x0240),
    "reports now and then it is off": lambda: states(0x0240, 3),
    "reports it is in a quick stop": lambda: states(0x8207),
    "reports it is in fault": lambda: states(0x0208),
    "answers each third request": answers_each_third,
}


def moved_s(order: Callable[[VirtualRig], None], lie: str, robot: str) -> float:
    """Return how long a robot moves on whose left drive ignores its set-points, from an order on."""
    with driving(robot) as rig, ExitStack() as stack:
        stack.enter_context(changed(rig, "left", LIES[lie]()))
        rig.fault("set_points_ignored", node="left")
        rig.runs(0.5)
        order(rig)
        return runs(rig, 6.0)


@pytest.mark.long(keeps=["reports the truth"])
@every("robot", ["rars", "climber"])
@pytest.mark.parametrize("lie", LIES)
def test_an_order_to_stop_is_no_slower_than_the_stick_let_go(robot: str, lie: str) -> None:
    let_go = moved_s(WEAKEST, lie, robot)
    cycle_s = to_seconds(robot_of(robot).cycle)
    for order in STRONGER:
        assert moved_s(ORDERS[order], lie, robot) <= let_go + cycle_s + STEP_S, order
