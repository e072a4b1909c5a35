"""Texts of the page on safety beside its tables."""

from collections.abc import Mapping
from typing import Final

from firmware_bridge.bridge.bridge import SECOND_REQUEST_WITHIN
from firmware_bridge.bridge.permission import BRAKED_WITHIN
from firmware_bridge.bridge.power_down import LOOKS_FOR, WATCHED_FOR
from firmware_bridge.bridge.stops import RAMPED_WITHIN
from firmware_bridge.drivers.all_drivers import alone
from firmware_bridge.drivers.stop_stages import TAKEN_WITHIN
from firmware_bridge.families.ar2.settings import Ar2Link
from firmware_bridge.families.motor_shield.settings import ShieldLink, ShieldProtocol
from firmware_bridge.family import family_of
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, SECOND

STOPS_TEXT: Final = """Each stop of an axis must be confirmed by a report of its device
that is newer than the stop, which is stated with each robot. A stage that is not confirmed within its time is
followed by the next one, the operator is informed, and the robot is disarmed. No stage lasts longer than
stated, whatever the device reports meanwhile. A stop does not wait for a start-up, a query or a quiet line.
The bridge's own ramp down, {ramped} s at most, comes before the first stage. The first stage that disables
the power stage has ended {taken} s after the stop began, at the latest. A confirmed stop begins again if no
more reports arrive, or if one shows the axis moving under power. **Of** is the purpose of the stage: a stop,
a commanded power-off (forced disarm, end of the program), or both. **Within** does not include the ramp:
without observed deceleration, and with it; **from top speed** includes the ramp. A stage ends earlier without
reports: after the link's `silent_ms`, or after the shorter time alone if the device reports that it is not
receiving. On a link of EPOS2 drives the stage `silence` is skipped for an axis that was at standstill in its
last report, and the times are set in the robot file, `links.NAME.stop_confirmed_ms`. While a stop escalates,
arming is refused. If all stages have failed, the last line of the program reports it, its exit status is not
0, and the next stop command starts again with the first stage."""
SAFETY_TEXT: Final = """\
**None of this is a rated safety function: it has no performance level (ISO 13849-1) and no SIL (IEC 61508,
IEC 61800-5-2).** A command over a network is no emergency stop in the sense of ISO 13850: keep a hardware one
within reach. An EPOS2 that is disabled has its power stage disabled, which is no STO. Times and distances
come from simulation, not from measurements on a robot. People are not detected. Stops are comparable to the
stop categories of EN 60204-1 and to SS1 and SS2 of IEC 61800-5-2, limits of speed to its SLS: in kind only.

Interlocks, limits and stops of the robots in this package; `firmware-bridge robots` checks others.

**Severity** is that of the text to the operator, by MAVLink: *emergency* (the robot falls), *critical* and
*error* (a device, a link or the robot's place is at fault), *warning* (a command or a state does not fit),
*notice* and *info* (nothing to do). *Stop* is a warning with which the whole robot stops.

An active interlock stops everything, or the axis groups that its **reaction** names. It clears after its
condition has been absent for the **release delay** at every evaluation. One that leaves the robot disarmed
withdraws the motion permission: to continue, arm again. While one that **blocks arming** is active, the robot
cannot be armed. One that is latched stays active until it is reset by command. On a link whose
`stops` names groups, the interlock of the link and those of its axes stop these groups alone, and do not
disarm.

A **second controller** is any other sender on a CAN link of what only the master of its drives sends: network
commands, SYNC, set-points to these drives, a heartbeat with the bridge's own node number. One such frame
counts for 1 s. A starting bridge listens for `bridge_silent_ms` before it sends anything, and refuses to
start if it receives such a frame; if it is ended before that, it leaves the drives as they are. Behind a
gateway a serial line shows no traffic of the bus, so a second controller is not detected there. Reading and
writing objects, as an engineer does with a tool, does not count."""
ROBOTS_TEXT: Final = """Worst case of each: the longest stop from top speed, of a device that confirms
nothing, and the time by which every stop stage is over; before it a device or the operator may be silent for
as long as stated."""
ROBOT_TEXT: Final = """What is alike for every robot, and what none of this is, [is here](safety.md)."""
AXIS_TEXT: Final = """Each axis is judged by these interlocks. While one is active, everything stops, and the
robot is disarmed. An interlock **needs** certain reports of a driver's devices. Without them, the weaker
interlock named under **without it** replaces it; if there is none, the robot file is refused. One that
**disables power** switches off the power stage of its axis until the robot is armed again, because an axis
whose feedback is untrusted cannot be ramped down. The last row is for an axis that the robot's current mode
does without."""
PLAUSIBILITY_TEXT: Final = """The plausibility limits give each axis a range that follows from what was sent
to it: a range of speeds after a speed set-point or a stop, else of positions. The range extends to a new
set-point at once. It leaves an old one after **lag**, and no faster than **ramp** or **cruise**. An axis
deviates if it is outside its range by more than **speed**, and a 50th of the commanded speed, or by more
than **position**, in every sample **within** this time. If it moves further, faster or in another direction
than commanded, this is uncommanded motion, else a tracking error. A position that repeats to the last bit
for as long may differ by no more than **repeats** from the commanded one, and an axis may stand at no more
than **holding current** for twice as long. A robot is at standstill when each axis that moves it is slower
than **standstill below**. All values are computed from top speed, drive and link unless
`[axes.plausibility]` in the robot file sets them."""
LETTING_GO_TEXT: Final = """Which stops end without power, and which keep it. Category 0 disables the power
stage at once, category 1 at standstill, category 2 keeps it enabled (EN 60204-1).

* **Disarmed**: category 2, on a slope and on the flat.
* **Emergency stop, end of the program**: category 1 if the robot does not roll without power. All axes keep
  their torque until the base is at standstill. For {looks} ms the current is measured with which each
  **free** axis stands. If **friction** explains it, all power stages are disabled together; for {watched} s a
  free axis that moves is enabled again. If it does not, or if a current is not known, the bridge reports "on
  a slope: held with power": category 2, until power off is commanded.
* **Forced disarm**: category 1 in any place: quick stop, and no power at standstill, or after {braked} s at
  the latest. This command also releases a robot that is held with power. At the end of the program, a second
  request within {again} s has the same effect.
* **A bridge that is dead**, killed or cut off, stops nothing: what stops the axes then is stated with each
  robot.

An axis marked **holds** stands without power, by its gear; the robot file states it with
`unpowered = "holds"`. Without `friction` in `[axes.plausibility]`, friction is taken as a 20th of the motor's
continuous current."""
GUARD_TEXT: Final = """The output guard shares neither code nor state with the interlocks. It passes no
set-point beyond the bounds of the robot's page, no sum of speeds beyond its own bound, and no motion of one
side while the other may move.

{more}"""
GUARDED: Final[Mapping[str, str]] = {
    "EPOS2 drives": "it ends a drive's watchdog over the bridge only after a statusword without power, and"
    " resets it only when the controlword that disables the power stage has been in force for `by_object` and"
    " no statusword has confirmed it",
    "motor shields": "it passes no reset of a board while one of its motors may move",
    "AR2": "it passes one move at a time, and none from a position that was not confirmed",
}
"""Further functions of a link's guard, by the link's devices."""
AGE_TEXT: Final = """\
A motion command that is older than `operator.max_age_ms` when it would be executed is not executed. Its age
is the largest that the methods below give. The first method that dates it is off by half the shortest round
trip at most. It dates nothing if another method gives an age that is larger by more than
`operator.max_age_ms`: the clocks of the station disagree, which is reported once. A command that no method
dates is subject to the operator link timeout alone, or moves nothing: `operator.unknown_age`. A stop command
is executed whatever its age, and no older command cancels it. [Why](decisions/command-age.md). A session may
agree on a larger age, up to `operator.max_age_ceiling_ms`: the robot is then
[slower](decisions/command-age.md) by the same factor."""
STEPPER_POWER_TEXT: Final = """**An arm on stepper motors** (AR2) is another
matter. No command of the bridge removes the motors' current: the board has no command for it, and the motor
drivers keep the current on. So every stop is of category 2 (EN 60204-1), whatever causes it: disarming, the
emergency stop, a forced disarm, the end of the program, a bridge that is dead or cut off. No further move is
sent, the one in progress is completed, and the motors hold the arm where it is.

The emergency stop that removes the power is a switch in the motors' supply, within reach of the operator.
**Without current the arm falls**: [how far and how fast](../fmu/ar2/README.md#how-it-falls). No one stands
below it.

"Disables power", "no torque" and "power off" in the tables have a weaker meaning for such an arm: the board
has echoed the request behind the last move, so nothing moves, and nothing further is sent."""

ARM_FALLS_TEXT: Final = """No command removes the arm's current. **Without it the arm falls**: [its
switch](safety.md#power-after-a-stop)."""

UNWATCHED_TEXT: Final = """A firmware without a watchdog lets the motors run on as commanded, without limit,
if the bridge ends, is killed or cut off. `drive` starts on such a board only with `--accept-no-watchdog`, or
with `accept_no_watchdog = true` in `[links.NAME]`. This project's sketch, `emulators/arduino_omni/sketch`
(protocol ros-arduino-bridge), stops them by itself. Keep the switch of their supply within reach."""
NO_WATCHDOG_TEXT: Final = """\
**No watchdog** on `{link}` with {without}: [the motors run on](safety.md#power-after-a-stop)."""


def power_text() -> str:
    """Return what becomes of a robot's power after a stop, in words that are true of every robot."""
    base = LETTING_GO_TEXT.format(
        looks=LOOKS_FOR // MILLISECOND,
        watched=WATCHED_FOR // SECOND,
        braked=BRAKED_WITHIN // SECOND,
        again=SECOND_REQUEST_WITHIN // SECOND,
    )
    return f"{base}\n\n{UNWATCHED_TEXT}\n\n{STEPPER_POWER_TEXT}"


def stops_text() -> str:
    """Return how axes are stopped."""
    return STOPS_TEXT.format(ramped=RAMPED_WITHIN // SECOND, taken=TAKEN_WITHIN // SECOND)


def confirmed_text(robot: AnyRobot) -> str:
    """Return what confirms a stop on each of a robot's links."""
    links = [name for name in robot.links if robot.axes_on(name)]
    return "\n".join(f"* `{name}`: {family_of(robot.links[name]).confirmed_by}." for name in links)


def guard_text() -> str:
    """Return what a guard does."""
    return GUARD_TEXT.format(more="\n".join(f"* **{whom}**: {what}." for whom, what in GUARDED.items()))


def dead_text(robot: AnyRobot) -> str:
    """Return the effect of a dead bridge, link by link, from the link's driver."""
    lines = ["What stops the axes when the bridge is dead:", ""]
    for name, link in robot.links.items():
        if isinstance(link, ShieldLink):
            lines += [f"* `{name}`, {_spoken(protocol)}" for protocol in _protocols(robot, name)]
        elif states := alone(robot, name):
            lines.append(f"* `{name}`: {states}.")
    if Ar2Link.all_of(robot):
        lines += ["", ARM_FALLS_TEXT]
    return "\n".join(lines)


def watchdog_text(robot: AnyRobot) -> str:
    """Return which firmwares on a robot's boards have no watchdog; the first line of its section."""
    parts = []
    for name in ShieldLink.all_of(robot):
        without = [one.value for one in ShieldProtocol if not _over(robot, name, one)]
        parts.append(NO_WATCHDOG_TEXT.format(link=name, without=", ".join(without)))
    return "\n\n".join(parts)


def _protocols(robot: AnyRobot, name: str) -> list[tuple[str, str]]:
    return [(one.value, _over(robot, name, one)) for one in ShieldProtocol]


def _over(robot: AnyRobot, name: str, protocol: ShieldProtocol) -> str:
    link = ShieldLink.of_link(robot, name).over(protocol, robot.cycle_ms, None)
    return alone(robot.with_links({name: link}), name)


def _spoken(row: tuple[str, str]) -> str:
    protocol, states = row
    return f"{protocol}: {states or '**nothing: the motors keep running as commanded**'}."
