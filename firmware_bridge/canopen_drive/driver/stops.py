"""The stop stages of one drive: rows, the gentlest first.

Sources: Controlwords as in `canopen_drive.driver.set_point`; heartbeat consumer (0x1016), its reaction
(0x6007) and reset node, which disables the power: CiA 301 and CiA 402. In which network states the consumer
lives is inferred: CiA 301 has error control in all of them, stopped included, SDO in all but stopped, PDO in
operational only. Reset communication restores the saved 0x1016, by default no heartbeat consumer: then
silence stops no drive, and objects or the reset must.
"""

from typing import Final, NamedTuple

from firmware_bridge.canopen_drive.settings import DriveAxis, DriveLink
from firmware_bridge.drivers.driver import Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.drivers.stop_stages import CREEPS, StopStage
from firmware_bridge.robot import AnyRobot, Axis
from firmware_bridge.units import RPM_PER_RAD_S


class Carrier(NamedTuple):
    """How commands reach a drive, for people."""

    written: str
    silence: str
    reset: str
    process_data: bool
    """True where a Controlword goes by PDO in every cycle, and by SDO beside it: two ways to the drive."""


ON_CAN: Final = Carrier("by PDO", "the bridge's heartbeat withheld", "NMT reset node", process_data=True)
CONFIRMED_BY: Final = "a sample with the axis at standstill, or a statusword of a state without torque"


def stop_stages(robot: AnyRobot, axis: Axis, carrier: Carrier = ON_CAN) -> tuple[StopStage, ...]:
    """Return the stop stages of one drive of a robot. TypeError where no such drive is on its link."""
    link = DriveLink.of_link(robot, axis.link)
    times, over_can = link.confirmed(robot.cycle), carrier.process_data
    per_unit = axis.ratio * RPM_PER_RAD_S
    quick = DriveAxis.of(axis).profile.quick_stop_rpm_s / per_unit
    how = carrier.written
    gentle = (
        StopStage(
            "ramp",
            f"target 0, or halt, {how} in every cycle",
            Stop.STANDSTILL,
            max(CREEPS, times.ramp),
            DriveAxis.of(axis).profile.deceleration_rpm_s / per_unit,
            slows_within=times.ramp,
        ),
        StopStage(
            f"quick stop {how}",
            f"NMT start, so that it receives; 0x6040 = 0x000B {how} in every cycle",
            Stop.QUICK_STOP,
            max(CREEPS, times.quick_stop),
            quick,
            slows_within=times.quick_stop,
            transition=Transition.LISTEN,
        ),
    )
    # On a serial line objects are written in either case: there is one way to a drive, and no other to try.
    over_can_alone = (
        StopStage(
            f"power off {how}",
            f"0x6040 = 0x0000 {how} in every cycle",
            Stop.POWER_OFF,
            times.power_off,
            ends_power=True,
            ordered_off=True,
        ),
        StopStage(
            "quick stop by SDO",
            "0x6040 = 0x000B by SDO, and 0x6028 until standstill",
            Stop.QUICK_STOP,
            times.by_object,
            quick,
            transition=Transition.QUICK_STOP,
            ends_with_transition=True,
        ),
    )
    at_last = (
        StopStage(
            "power off by SDO" if over_can else f"power off {how}",
            f"0x6040 = 0x0000 {'by SDO' if over_can else how}, and 0x6041 until it confirms",
            Stop.POWER_OFF,
            # A serial line may have to wait first for what a silent drive keeps it with.
            times.by_object if over_can else 2 * times.by_object,
            transition=Transition.POWER_OFF,
            ends_power=True,
        ),
        StopStage(
            "silence",
            carrier.silence,
            Stop.POWER_OFF,
            times.silence,
            quick,
            silent=True,
            takes_all=True,
            ends_power=True,
            note="every drive on the link stops by its heartbeat consumer; then no power",
        ),
        StopStage(
            "reset",
            carrier.reset,
            Stop.POWER_OFF,
            times.reset,
            transition=Transition.RESET,
            ends_power=True,
            note="no torque from then on; the drive's reference is lost",
        ),
    )
    return (*gentle, *(over_can_alone if over_can else ()), *at_last)


def alone(robot: AnyRobot, link: str) -> str:
    """Return what stops the drives on a link when the bridge falls silent."""
    silent = DriveLink.of_link(robot, link).bridge_silent_ms
    return f"each drive's heartbeat consumer, after {silent} ms: quick stop, then no power"
