"""Why a drive that is commanded does not move: a row for each reason, the most telling ones first.

A row looks at nothing but the drive's state as the frames show it. Sources: CiA 301 (NMT, PDO), CiA 402-2.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import ControlwordBit, Mode, PowerState, Status, towards, word_of
from firmware_bridge.explain.drive_state import (
    FAULTS,
    MAX_MOTOR_SPEED,
    POSITIONS,
    TARGETS,
    DriveState,
)
from firmware_bridge.explain.incident import Evidence

_ENABLED: Final = PowerState.OPERATION_ENABLED
_FOLLOWING: Final = frozenset({Mode.PROFILE_POSITION, Mode.CYCLIC_POSITION, -1})
_BY_PROFILE: Final = frozenset({Mode.PROFILE_POSITION, Mode.PROFILE_VELOCITY})
_NO_TARGET: Final = frozenset(
    {Mode.HOMING, Mode.INTERPOLATED_POSITION, Mode.PROFILE_TORQUE, Mode.CYCLIC_TORQUE}
)


@dataclass(frozen=True, slots=True)
class Reason:
    """One reason: its name, when it holds, what is wrong, and what to do."""

    name: str
    holds: Callable[[DriveState], bool]
    text: Callable[[DriveState], str]
    remedy: str
    evidence: Callable[[DriveState], Evidence | None] = lambda drive: drive.control


def _not_operational(drive: DriveState) -> bool:
    return drive.ignored_pdo is not None and drive.network not in {None, NmtState.OPERATIONAL}


def _network(drive: DriveState) -> str:
    state = "unknown" if drive.network is None else drive.network.title
    return f"its NMT state is {state}: PDOs are ignored"


def _invalid(drive: DriveState) -> str:
    if drive.invalid_pdo is None:
        return ""
    _, title, address = drive.invalid_pdo
    return f"{title} is switched off (bit 31 of {address}): its set-points are ignored"


def _untransitioned(drive: DriveState) -> str:
    if drive.no_transition is None:
        return ""
    _, word, state = drive.no_transition
    step = towards(state, _ENABLED)
    first = "" if step is None else f": write 0x{word_of(step):04X} first"
    return f"controlword 0x{word:04X} in {state.title} has no transition{first}"


def _not_enabled(drive: DriveState) -> bool:
    return drive.state in {
        PowerState.SWITCH_ON_DISABLED,
        PowerState.READY_TO_SWITCH_ON,
        PowerState.SWITCHED_ON,
    }


def _state(drive: DriveState) -> str:
    state = drive.state
    step = towards(state, _ENABLED)
    word = "" if step is None else f"; next: controlword 0x{word_of(step):04X} ({step.value})"
    return f"it is not enabled: {'unknown' if state is None else state.title}{word}"


def _mode_not_confirmed(drive: DriveState) -> bool:
    written, shown = drive.values.get(od.MODE), drive.values.get(od.MODE_DISPLAY)
    return written is not None and shown is not None and written != shown


def _no_mode(drive: DriveState) -> bool:
    return drive.mode in {None, 0} and bool(drive.written_targets)


def _wrong_target(drive: DriveState) -> bool:
    target = drive.target
    return target is not None and bool(drive.written_targets) and target not in drive.targets


def _other_targets(drive: DriveState) -> str:
    written = ", ".join(map(str, drive.written_targets))
    return f"{written} was written, but mode {drive.mode} takes its target from {drive.target}"


def _no_target(drive: DriveState) -> bool:
    return drive.enabled and not drive.written_targets and drive.mode not in _NO_TARGET


def _at_target(drive: DriveState) -> bool:
    target = drive.target
    if not drive.enabled or target is None or target not in drive.targets:
        return False
    value = drive.values.get(target)
    return value == (drive.values.get(od.POSITION_ACTUAL) if target in POSITIONS else 0)


def _set_point_missing(drive: DriveState) -> bool:
    if drive.mode != Mode.PROFILE_POSITION or not drive.enabled or od.TARGET_POSITION not in drive.targets:
        return False
    return drive.edge_at is None or (
        not drive.bit(ControlwordBit.NEW_SETPOINT) and drive.edge_at < drive.targets[od.TARGET_POSITION]
    )


def _edge_too_early(drive: DriveState) -> bool:
    if drive.mode != Mode.PROFILE_POSITION or drive.edge_at is None or not drive.enabled:
        return False
    set_at = drive.targets.get(od.TARGET_POSITION)
    return drive.bit(ControlwordBit.NEW_SETPOINT) and (
        not drive.edge_enabled or (set_at is not None and drive.edge_at < set_at)
    )


def _edge(drive: DriveState) -> str:
    when = "was set before the target was written" if drive.edge_enabled else "was set before it was enabled"
    return f"bit 4 of the controlword (new set-point) {when}, and has had no 0 -> 1 change since"


def _homing_not_started(drive: DriveState) -> bool:
    return drive.mode == Mode.HOMING and drive.enabled and not drive.bit(ControlwordBit.NEW_SETPOINT)


def _zero(drive: DriveState) -> list[Address]:
    limits = [od.MAX_PROFILE_VELOCITY, MAX_MOTOR_SPEED]
    if drive.mode == Mode.PROFILE_POSITION:
        limits.insert(0, od.PROFILE_VELOCITY)
    return [address for address in limits if drive.values.get(address) == 0]


def _beyond_limits(drive: DriveState) -> bool:
    target = drive.values.get(od.TARGET_POSITION)
    low = drive.values.get(od.MIN_POSITION_LIMIT)
    high = drive.values.get(od.MAX_POSITION_LIMIT)
    if target is None or drive.target not in POSITIONS:
        return False
    return (low is not None and target < low) or (high is not None and target > high)


def _limits(drive: DriveState) -> str:
    low, high = (drive.values.get(one, "-") for one in (od.MIN_POSITION_LIMIT, od.MAX_POSITION_LIMIT))
    return f"target {drive.values[od.TARGET_POSITION]} is beyond the limits 0x607D: {low} to {high}"


def _accelerates_not(drive: DriveState) -> bool:
    return drive.mode in _BY_PROFILE and drive.values.get(od.PROFILE_ACCELERATION) == 0


REASONS: Final = (
    Reason(
        "not_operational",
        _not_operational,
        _network,
        "send NMT start: 000#01 and the node's number",
        lambda drive: drive.ignored_pdo,
    ),
    Reason(
        "pdo_invalid",
        lambda drive: drive.invalid_pdo is not None,
        _invalid,
        "write its COB-ID without bit 31, after the mapping",
        lambda drive: None if drive.invalid_pdo is None else drive.invalid_pdo[0],
    ),
    Reason(
        "fault",
        lambda drive: drive.state in FAULTS,
        lambda drive: f"it is in {PowerState.FAULT.title if drive.state is None else drive.state.title}",
        "remove the cause (0x1003), then controlword 0x0080: bit 7 needs a 0 -> 1 change",
    ),
    Reason(
        "no_transition",
        lambda drive: drive.no_transition is not None and not drive.enabled,
        _untransitioned,
        "0x0006, 0x0007, 0x000F, each when the statusword shows the state before it",
        lambda drive: None if drive.no_transition is None else drive.no_transition[0],
    ),
    Reason(
        "quick_stop",
        lambda drive: drive.state is PowerState.QUICK_STOP_ACTIVE,
        lambda _: "quick stop is active",
        "controlword 0x000F, or 0x0000 and then 0x0006, 0x0007, 0x000F",
    ),
    Reason(
        "not_enabled",
        lambda drive: _not_enabled(drive) and drive.no_transition is None,
        _state,
        "0x0006, 0x0007, 0x000F, each when the statusword shows the state before it",
    ),
    Reason(
        "not_remote",
        lambda drive: (
            drive.statusword is not None
            and not drive.shows(Status.REMOTE)
            and drive.network in {None, NmtState.OPERATIONAL}
        ),
        lambda _: "statusword bit 9 (remote) is 0: it does not take the controlword from the bus",
        "the NMT state, and the drive's source of commands",
    ),
    Reason(
        "halt",
        lambda drive: drive.bit(ControlwordBit.HALT),
        lambda _: "controlword bit 8 (halt) is set",
        "write the controlword without 0x0100",
    ),
    Reason(
        "mode_not_confirmed",
        _mode_not_confirmed,
        lambda drive: (
            f"mode {drive.values[od.MODE]} was written to {od.MODE}, but {od.MODE_DISPLAY} shows "
            f"{drive.values[od.MODE_DISPLAY]}"
        ),
        "a mode that the drive has (0x6502), written while the state allows it",
    ),
    Reason(
        "no_mode",
        _no_mode,
        lambda _: "no mode of operation was set: 0x6060 was not written, or is 0",
        "write 0x6060: 1 profile position, 3 profile velocity",
    ),
    Reason(
        "wrong_target",
        _wrong_target,
        _other_targets,
        "map and write the target of the mode",
    ),
    Reason(
        "no_target",
        _no_target,
        lambda drive: (
            "no target was written"
            if drive.mode not in TARGETS
            else f"no target was written: mode {drive.mode} takes it from {drive.target}"
        ),
        "write the target of the mode, by a PDO or by SDO",
    ),
    Reason(
        "at_target",
        _at_target,
        lambda drive: (
            f"the target {drive.target} is the actual position"
            if drive.target in POSITIONS
            else f"the target {drive.target} is 0"
        ),
        "write another target",
    ),
    Reason(
        "no_set_point",
        _set_point_missing,
        lambda _: "the target was written, but bit 4 of the controlword (new set-point) was not set after it",
        "controlword 0x001F after the target, then 0x000F",
    ),
    Reason(
        "no_edge",
        _edge_too_early,
        _edge,
        "controlword 0x000F, then the target, then 0x001F",
    ),
    Reason(
        "homing_not_started",
        _homing_not_started,
        lambda _: "the mode is homing, and bit 4 of the controlword (start) is 0",
        "controlword 0x001F",
    ),
    Reason(
        "zero_velocity",
        lambda drive: bool(_zero(drive)),
        lambda drive: f"{', '.join(map(str, _zero(drive)))} is 0: there is no velocity to move with",
        "write a velocity: 0x6081 of the profile, 0x607F and 0x6080 as its limits",
    ),
    Reason(
        "zero_acceleration",
        _accelerates_not,
        lambda _: f"{od.PROFILE_ACCELERATION} is 0",
        "write an acceleration",
    ),
    Reason(
        "beyond_limits",
        _beyond_limits,
        _limits,
        "a target within 0x607D, or other limits",
    ),
    Reason(
        "no_sync",
        lambda drive: bool(drive.waits_for_sync) and not drive.sync_since,
        lambda drive: f"{drive.waits_for_sync} waits for SYNC, and no SYNC (080#) came",
        "send SYNC, or transmission type 255 in 0x1400:2",
    ),
    Reason(
        "following_error",
        lambda drive: drive.mode in _FOLLOWING and drive.shows(Status.FOLLOWING_ERROR),
        lambda _: "following error, statusword bit 13",
        "free movement of the axis; then 0x6065",
    ),
    Reason(
        "internal_limit",
        lambda drive: drive.shows(Status.INTERNAL_LIMIT),
        lambda _: "internal limit active, statusword bit 11",
        "current limit, load, brake, and the limits 0x607D and 0x607F",
    ),
)
"""The reasons, in the order in which they are reported."""
_UNCERTAIN: Final = frozenset({"no_mode", "not_remote"})
"""Reasons that are left out where another one is certain."""


def reasons_of(drive: DriveState) -> tuple[Reason, ...]:
    """Return the reasons that hold, the most telling one first."""
    holding = [reason for reason in REASONS if reason.holds(drive)]
    certain = [reason for reason in holding if reason.name not in _UNCERTAIN]
    return tuple(certain or holding)
