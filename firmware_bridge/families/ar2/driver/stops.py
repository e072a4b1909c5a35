"""The stop stages of the arm, with the board's answer that confirms each.

A move that was sent is driven to its end, and lasts as long as the robot file lets it; no ordinary stop is
more than to send no further one. The board reports no power: the motors keep their current, and hold the arm.
It ends by a switch in their supply, and the arm falls then.
"""

from typing import Final

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.drivers.stop_stages import StopStage
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import MILLISECOND

CONFIRMED_BY: Final = "an answer to the request behind the last move"


def stop_stages(robot: AnyRobot, axis: Axis) -> tuple[StopStage, ...]:
    """Return the stop stages of one joint of a robot. TypeError where no AR2 is on its link."""
    link = robot.links[axis.link]
    if not isinstance(link, Ar2Link):
        raise TypeError(f"no AR2 is on the link of '{axis.name}'")
    within = link.confirmed(robot.cycle)
    return (
        StopStage(
            "no further move",
            f"nothing; the last move ends within {link.move_ms} ms",
            Stop.STANDSTILL,
            within,
            at_once=True,
            received=True,
        ),
        StopStage(
            "question",
            "a request, which is answered when nothing moves",
            Stop.POWER_OFF,
            within + link.answers_within_ms * MILLISECOND,
            transition=Transition.POWER_OFF,
            ends_power=True,
            note="the motors keep their current, and hold",
        ),
        StopStage(
            "reset",
            "DTR down and up: a move in progress ends",
            Stop.POWER_OFF,
            (link.boots_within_ms + link.answers_within_ms) * MILLISECOND,
            transition=Transition.RESET,
            ends_power=True,
            note="the arm's position is unknown then; the motors keep their current, and hold",
        ),
    )


def alone(robot: AnyRobot, link: str) -> str:
    """Return what stops the joints when the bridge falls silent."""
    move = Ar2Link.of_link(robot, link).move_ms
    return f"the end of the last move, within {move} ms: no other follows, and the motors hold"
