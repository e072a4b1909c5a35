"""The stop stages of a motor at a shield: rows, the gentlest first.

No firmware reports a motor's power. Its release is known when the board has answered a request that was sent
after it: commands are obeyed in their order.

A board that is silent hangs, or is starting again; the two look alike. To wait for the one is to let the
other run on, and a byte to a board in its boot loader keeps it there: so a silent board is commanded to
release once, and is then reset at once, and nothing is sent until it must have booted.
"""

from typing import Final

from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.drivers.stop_stages import CREEPS, StopStage
from firmware_bridge.families.motor_shield.driver.dialects import DIALECTS
from firmware_bridge.families.motor_shield.driver.plan import takes
from firmware_bridge.families.motor_shield.settings import ShieldAxis, ShieldLink
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

SET_UP_WITHIN: Final[Nanoseconds] = SECOND
"""From a board's first answer after its reset until it has released its motors."""

CONFIRMED_BY: Final = "counts with the axis at standstill, or an answer to the request behind its release"


def stop_stages(robot: AnyRobot, axis: Axis) -> tuple[StopStage, ...]:
    """Return the stop stages of one motor of a robot. TypeError where no shield is on its link."""
    link = robot.links[axis.link]
    if not isinstance(link, ShieldLink):
        raise TypeError(f"no motor shield is on the link of '{axis.name}'")
    within = link.confirmed(robot.cycle)
    # Each motor may be released with a command of its own, and none of them may be answered; nor any at all
    # of those to a board that may have lost its set-up, which take their time on the line.
    axes = [ShieldAxis.of(it) for it in robot.axes_on(axis.link)]
    again = DIALECTS[link.protocol](link, axes).release_again(motor.port for motor in axes)
    lasts = sum(takes(link, command) for command in again)
    requested = link.answers_within_ms * MILLISECOND
    longest = max(len(axes) * requested, lasts + requested)
    board = link.stops_itself
    runs_on = "the motors keep running while it boots: the shield has no wire to the board's reset"
    if board:
        runs_on += f"; without commands it stops them {link.auto_stop_ms} ms after the last one"
    return (
        StopStage(
            "speed 0",
            "speed 0" if board else "PWM down to 0 on its slope",
            Stop.STANDSTILL,
            max(CREEPS, within),
            ShieldAxis.of(axis).acceleration,
            slows_within=within,
            received=True,
        ),
        StopStage(
            "brake",
            "speed 0" if board else "PWM 0 at once: the half bridge shorts the motor",
            Stop.QUICK_STOP,
            within,
            ShieldAxis.of(axis).acceleration,
            received=True,
        ),
        StopStage(
            "release",
            "speed 0 for all motors, and a request" if board else "release, and a request",
            Stop.POWER_OFF,
            longest,
            transition=Transition.POWER_OFF,
            whole_board=board,
            ends_power=True,
        ),
        StopStage(
            "reset",
            "DTR down and up; the board is set up again, beginning with the release",
            Stop.POWER_OFF,
            link.boots_within_ms * MILLISECOND + SET_UP_WITHIN,
            transition=Transition.RESET,
            ends_power=True,
            note=runs_on,
        ),
    )


def alone(robot: AnyRobot, link: str) -> str:
    """Return what stops the motors of a board when the bridge falls silent; empty where nothing does."""
    table = ShieldLink.of_link(robot, link)
    if table.unwatched:
        return ""
    return (
        f"the firmware's auto-stop, {table.auto_stop_ms} ms after the last command: speed 0, which releases"
    )
