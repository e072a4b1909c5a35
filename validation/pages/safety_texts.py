"""Texts of the page on safety beside its tables."""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.bridge.bridge import SECOND_REQUEST_WITHIN
from firmware_bridge.bridge.permission import BRAKED_WITHIN
from firmware_bridge.bridge.power_down import LOOKS_FOR, WATCHED_FOR
from firmware_bridge.bridge.stops import RAMPED_WITHIN
from firmware_bridge.drivers.fleets import CONFIRMED_BY, alone
from firmware_bridge.drivers.stop_steps import TAKEN_WITHIN
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.settings.ar2 import Ar2Driver
from firmware_bridge.robot.settings.epos2 import Epos2Driver
from firmware_bridge.robot.settings.shield import ShieldDriver, ShieldLink, ShieldProtocol
from firmware_bridge.units import MILLISECOND, SECOND

STOPS_TEXT: Final = """Whatever stops an axis, its device's own report must confirm it, newer than the stop:
{confirmed}. A step that is not confirmed in its time gives way to the next one, the operator is informed, and
the robot is disarmed. No step lasts longer than its row says, whatever the device reports meanwhile, and a
stop waits for no start-up, no query and no quiet line; the bridge's own ramp down, {ramped} s at most,
comes before the first. The first step that takes the power has ended {taken} s after the stop began, at the
latest. A stop that was confirmed begins again where no report comes any more, or one says that the axis
moves with power. **Of** says what the step belongs to: a stop, a power-off that was ordered (forced disarm,
the end of the program), or both. **Within** counts beside the ramp: where the axis is not seen to slow
down, and where it is; **from top speed** with the ramp. A step ends sooner where nothing is reported: after
the link's `silent_ms`, or where the device says that it does not listen after the shorter time alone.
{more}While a stop escalates, arming is refused. Where nothing is left to try, the last line of the program
says so, its exit status is not 0, and an order that stops begins it all again."""
EPOS2_STOPS_TEXT: Final = """The silence is left out for an axis that was at standstill when it last reported.
The times stand in the robot file, `links.NAME.stop_confirmed_ms`. """
SAFETY_TEXT: Final = """The robots that come with this package; `firmware-bridge robots` checks others.

A hold stops the groups that it names, and lets go when its row has been clear for its time at every look.
One that **disarms** takes the leave to move: to go on, arm again. While one that **blocks arming** holds, the
robot cannot be armed. One that **latches** sets the emergency stop, which stays until an order clears it. On
a link whose `stops` names groups, its own row and those of its axes stop these alone, and do not disarm.

**Another master** is whoever else sends on a CAN link what only the master of its drives sends: network
commands, SYNC, set-points to these drives, a heartbeat with the bridge's own node. Heard once, it counts for
1 s. A starting bridge listens for `bridge_silent_ms` before it sends anything, and refuses to start where it
hears one; ended until then, it leaves the drives as they are. Behind a gateway a serial line shows nothing of
the bus, so that there no one notices; reading and writing objects, as an engineer does, is not held against
anyone."""
AXIS_TEXT: Final = """Each axis is judged by these rows; while one holds, everything stops, and the robot is
disarmed. A row **needs** something that a driver's devices tell. Where they do not, the weaker row stands in
for it; where there is none, the robot file is refused. One that **takes power** switches its axis off until
the robot is armed again, for what is not believed cannot ramp. The last row is of an axis that the robot's
mode does without."""
BELIEF_TEXT: Final = """From what was sent to it each axis has a range in which it may be: of speeds
where it is told a speed or a stop, else of positions. The range reaches to a new demand at once, and leaves
an old one with **lag**, and no faster than with **ramp** or **cruise**. An axis that is beside its range by
more than **speed**, and a 50th of what it was told, or **position** at every sample **within** this time
deviates: it moves uncommanded where it moves further, faster or another way than commanded, else it does
not follow. A position that repeats to the last bit for as long may be behind by no more than **repeats** of
what was commanded; and it may stand with no more than **holds with** for twice as long. A robot rests when
each axis that takes it from its place is slower than **stands below**. All of them are worked out from top
speed, drive and link unless `[axes.belief]` in the robot file says otherwise."""
LETTING_GO_TEXT: Final = """What ends without power, and what keeps it. Category 0 takes the power at once,
1 at rest, 2 keeps it (EN 60204-1).

* **Disarmed**: category 2, on a slope and on the flat.
* **Emergency stop, end of the program**: category 1 where the robot stands by itself. All axes keep their
  torque until the base rests; for {looks} ms the current is looked at with which each
  **free** axis stands. No more than **friction** explains, and all let go together; {watched} s
  long a free axis that moves is given its power again. More, or a current that is not known: "on a slope:
  held with power", category 2, until it is ordered off.
* **Forced disarm**: category 1 in any place: quick stop, and at rest, or after {braked} s at
  the latest, no power. It is the order that lets a held robot go. Where the program ends, asking it twice
  within {again} s is that order, too.
{dead}

An axis that **holds** by itself stands without power, by its gear; the file says so with
`unpowered = "holds"`. Without `friction` in `[axes.belief]` friction counts as a 20th of the motor's
continuous current."""
GUARD_TEXT: Final = """The guard shares neither code nor state with the interlocks. It lets no set-point
pass that lies beyond these bounds, no sum of speeds beyond its own, and no motion of one side while the
other may move.{more}"""
GUARDED: Final[Mapping[str, str]] = {
    **dict.fromkeys(
        Epos2Driver,
        " It ends a drive's watchdog over the bridge only after a statusword without power, and resets it"
        " only when the word that takes the power has been in force for `by_object` and no statusword has"
        " confirmed it.",
    ),
    ShieldDriver.MOTOR_SHIELD: " It lets no reset of a board pass while one of its motors may move.",
    Ar2Driver.AR2: " It lets one move pass at a time, and none from a place that was not confirmed.",
}
"""Further functions of a link's guard, by the link's driver."""
AGE_TEXT: Final = """\
No motion command is obeyed that was said longer ago than `operator.max_age_ms`, counted to the instant at
which it is obeyed. It is as old as the oldest of these rows says; the first that dates it is off by half the
shortest round trip at most, and dates nothing where another one says more by over `operator.max_age_ms`: the
station's clocks disagree, which is told once. What no row dates is obeyed under the rule of
silence, or moves nothing: `operator.unknown_age`. A stop command is obeyed however old, and nothing that was
said before it undoes it. [Why](decisions/command-age.md). A session may agree on more, up to
`operator.max_age_ceiling_ms`: the robot is [slower then](decisions/command-age.md), by the same factor."""
STEPPER_POWER_TEXT: Final = """Nothing that the bridge says takes the motors' current: the board has no word
for it, and their drivers keep it. So every stop is of category 2 (EN 60204-1), whatever asks for it:
disarming, the emergency stop, a forced disarm, the end of the program, a bridge that is dead or cut off. No
further move is sent, the one that is under way is driven to its end within {move_ms} ms, and the motors hold
the arm where it is.

The emergency stop that takes the power is a switch in the motors' supply, within reach of who drives.
**Without current the arm falls**: [how far and how fast](../fmu/ar2/README.md#how-it-falls). No one stands
below it.

What "takes power", "no torque" and "power off" mean in the tables for this robot is weaker: the board has
echoed what was said after the last move, so nothing moves, and nothing further is sent."""

NO_WATCHDOG_TEXT: Final = """\
**No watchdog** on `{link}` with {without}: a bridge that ends, is killed or cut off leaves its motors running
as commanded, for ever. `drive` starts on such a board only with `--accept-no-watchdog`, or with
`accept_no_watchdog = true` in `[links.{link}]`. This project's sketch, `emulators/arduino_omni/sketch`
(protocol ros-arduino-bridge), stops them by itself. Keep the switch of their supply within reach."""
ARM_TEXT: Final = "Of the arm:"


def power_text(robot: AnyRobot) -> str:
    """Return what becomes of a robot's power, in words: of drives and half bridges, or of steppers."""
    if not robot.epos2_links and not robot.shield_links:
        (link,) = robot.ar2_links.values()
        return STEPPER_POWER_TEXT.format(move_ms=link.move_ms)
    base = LETTING_GO_TEXT.format(
        looks=LOOKS_FOR // MILLISECOND,
        watched=WATCHED_FOR // SECOND,
        braked=BRAKED_WITHIN // SECOND,
        again=SECOND_REQUEST_WITHIN // SECOND,
        dead=dead_text(robot),
    )
    arms = [STEPPER_POWER_TEXT.format(move_ms=link.move_ms) for link in robot.ar2_links.values()]
    return "\n\n".join((base, *([ARM_TEXT, *arms] if arms else ())))


def stops_text(robot: AnyRobot) -> str:
    """Return how a robot's axes are stopped, in words that are true of its devices."""
    drivers = _drivers(robot)
    return STOPS_TEXT.format(
        confirmed="; ".join(dict.fromkeys(CONFIRMED_BY[driver] for driver in drivers)),
        ramped=RAMPED_WITHIN // SECOND,
        taken=TAKEN_WITHIN // SECOND,
        more=EPOS2_STOPS_TEXT if robot.epos2_links else "",
    )


def guard_text(robot: AnyRobot) -> str:
    """Return what a robot's guard does, in words that are true of its devices."""
    return GUARD_TEXT.format(more="".join(dict.fromkeys(GUARDED[driver] for driver in _drivers(robot))))


def _drivers(robot: AnyRobot) -> list[str]:
    """Return the drivers of the links that axes are on."""
    return [link.driver for name, link in robot.links.items() if robot.axes_on(name)]


def dead_text(robot: AnyRobot) -> str:
    """Return the effect of a dead bridge, link by link, from the link's driver."""
    lines = ["* **A bridge that is dead**, killed or cut off, stops nothing; what does, is:"]
    for name, link in robot.links.items():
        if isinstance(link, ShieldLink):
            lines += [f"  * `{name}`, {_spoken(protocol)}" for protocol in _protocols(robot, name)]
        elif states := alone(robot, name):
            lines.append(f"  * `{name}`: {states}.")
    return "\n".join(lines)


def watchdog_text(robot: AnyRobot) -> str:
    """Return which firmwares on a robot's boards have no watchdog; the first line of its section."""
    parts = []
    for name in robot.shield_links:
        without = [one.value for one in ShieldProtocol if not _over(robot, name, one)]
        parts.append(NO_WATCHDOG_TEXT.format(link=name, without=", ".join(without)))
    return "\n\n".join(parts)


def _protocols(robot: AnyRobot, name: str) -> list[tuple[str, str]]:
    return [(one.value, _over(robot, name, one)) for one in ShieldProtocol]


def _over(robot: AnyRobot, name: str, protocol: ShieldProtocol) -> str:
    link = robot.shield_link(name).over(protocol, robot.cycle_ms, None)
    return alone(robot.with_links({name: link}), name)


def _spoken(row: tuple[str, str]) -> str:
    protocol, states = row
    return f"{protocol}: {states or '**nothing: the motors run on as commanded**'}."
