"""One row for each way to trip a stop interlock, just beyond its threshold, and the nearest that does not."""

import math
from dataclasses import dataclass, replace
from typing import Any, Final

from firmware_bridge.canopen.cia402 import PowerState
from firmware_bridge.drivers.driver import Homed, Position, Speed, Stop
from firmware_bridge.intent import NEVER_RECEIVED, AgeLimit
from firmware_bridge.safety.snapshot import Tracking
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds
from hil_tests.safety.gate_bench import above, stated

START: Final = 100 * SECOND
TITLES: Final = {
    "left": "node 1 (left rear wheel)",
    "right": "node 2 (right rear wheel)",
    "steer": "node 3 (steering)",
    "lift": "node 4 (scissor lift)",
}
MOVES: Final = {
    name: f"{title}, commanded 1.50 rad/s, moves with 0.25 rad/s" for name, title in TITLES.items()
}


@dataclass(frozen=True, slots=True)
class Case:
    """One way to trip one interlock, just beyond its threshold, and the nearest way that does not."""

    event: str
    trips: dict[str, Any]
    spares: dict[str, Any]
    reason: str
    clear_after: Nanoseconds = 0
    lift_is_free: bool = False
    also: tuple[str, ...] = ()
    """Other holds that come with it."""


def intent(**fields: Any) -> dict[str, Any]:
    return {"intent": fields}


def timestamped(age: Nanoseconds) -> dict[str, Any]:
    """Return the fields of a motion command that was sent so long ago, counted from the look."""
    return {"sent_at": START - age, "timestamped": True}


def drive(name: str, **fields: Any) -> dict[str, Any]:
    return {"drives": {name: fields}}


def follows(name: str, **fields: Any) -> dict[str, Any]:
    """Return the fields of one axis that follows all its commands, but for these fields."""
    known = Tracking(Speed(1.5), START, START, START, START, START, position=0.125, velocity=0.25)
    return {"following": {name: replace(known, **fields)}}


OPERATOR_LIMIT: Final = 500 * MILLISECOND
OPERATOR_GONE: Final = 10 * SECOND
DRIVE_LIMIT: Final = 250 * MILLISECOND
LINK: Final = 200 * MILLISECOND
HALTS: Final = 40 * MILLISECOND
BACKLOG: Final = 100 * MILLISECOND

CASES: Final = (
    Case("emergency stop", {"emergency_stopped": True}, {}, "the emergency stop is latched"),
    Case(
        "bridge stalled",
        {"stood_still": 500 * MILLISECOND},
        {"stood_still": 500 * MILLISECOND - 1},
        "the bridge itself did nothing for 0.50 s, limit 0.50 s",
    ),
    Case(
        "battery low",
        {"battery_low_since": START - 10 * SECOND},
        {"battery_low_since": START - 10 * SECOND + 1},
        "the battery has been below 21 V for 10.0 s",
        5 * SECOND,
    ),
    Case("not armed", {"armed": False}, {}, "the robot is not armed"),
    Case(
        "operator link timeout",
        intent(received_at=START - OPERATOR_LIMIT),
        intent(received_at=START - OPERATOR_LIMIT + 1),
        "no motion command for 0.50 s, limit 0.50 s",
        LINK,
    ),
    Case(
        "operator link lost",
        intent(received_at=START - OPERATOR_GONE),
        {},
        "no motion command for 10 s: no station in control",
        also=("operator link timeout",),
    ),
    Case(
        "stick not neutral",
        {"neutral_required": True, "neutral": False},
        {"neutral_required": True},
        "not neutral since the timeout: the stick",
    ),
    Case(
        "stick not neutral",
        {"neutral_required": True, "neutral": False},
        {"neutral": False},
        "not neutral since the timeout: the stick",
    ),
    Case("operation paused", {"paused": True}, {}, "the operator has paused the robot"),
    Case(
        "operator link timeout",
        intent(received_at=START - 200 * MILLISECOND) | timestamped(500 * MILLISECOND),
        intent(received_at=START - 200 * MILLISECOND + 1) | timestamped(500 * MILLISECOND - 1),
        "no motion command for 0.20 s, limit 0.20 s",
        LINK,
    ),
    Case(
        "command stale",
        timestamped(500 * MILLISECOND),
        timestamped(500 * MILLISECOND - 1),
        "the newest motion command was 0.50 s old when it came, limit 0.50 s",
        LINK,
    ),
    Case(
        "command stale",
        timestamped(500 * MILLISECOND) | {"timestamped": False},
        timestamped(500 * MILLISECOND - 1) | {"timestamped": False},
        "the newest motion command was at least 0.50 s old when it came, limit 0.50 s",
        LINK,
    ),
    Case(
        "command not timestamped",
        {"age_limit": AgeLimit(needed=True)},
        {"age_limit": AgeLimit(needed=True), **timestamped(0)},
        "the age of the motion commands is unknown",
        LINK,
    ),
    Case(
        "operator link timeout",
        intent(received_at=NEVER_RECEIVED),
        {},
        "no motion command has come yet",
        LINK,
    ),
    Case(
        "link lost: drives",
        {"link_lost": "the serial line to the drives is gone"},
        {},
        "the serial line to the drives is gone",
        LINK,
    ),
    Case(
        "second controller: drives",
        {"masters": {"drives": "someone else sends SYNC: 080#"}},
        {},
        "someone else sends SYNC: 080#",
        LINK,
    ),
    Case("command unusable", intent(speed_mps=math.nan), {}, "the speed requested is nan"),
    Case("command unusable", intent(speed_mps=math.inf), {}, "the speed requested is inf"),
    Case("command unusable", intent(steer_rad=math.nan), {}, "the steer angle requested is nan"),
    Case("command unusable", intent(steer_rad=-math.inf), {}, "the steer angle requested is -inf"),
    Case("command unusable", intent(lift_m=math.nan), {}, "the lift height requested is nan"),
    Case("command unusable", intent(lift_rate_mps=math.nan), {}, "the lift rate requested is nan"),
    Case("steer angle unknown", {"steer_rad": None}, {}, "the actual steer angle is not known"),
    Case("steer angle unknown", {"steer_rad": math.nan}, {}, "the actual steer angle is not known"),
    Case("steer angle unknown", {"steer_rad": math.inf}, {}, "the actual steer angle is not known"),
    Case("lift height unknown", {"lift_m": None}, {}, "the actual lift height is not known"),
    Case(
        "lift height unknown",
        {"lift_m": math.nan},
        {},
        "the actual lift height is not known",
        also=("lift extended",),
    ),
    Case(
        "lift extended",
        {"lift_m": above(0.005)},
        {"lift_m": 0.005},
        "the lift stands at 5 mm, retracted is below 5 mm",
        lift_is_free=True,
    ),
    *(
        Case(
            "lift moving",
            drive("lift", velocity=sign * above(0.10)),
            drive("lift", velocity=sign * 0.10),
            f"the lift's screw turns with {sign * 0.10:.2f} rad/s",
            LINK,
            lift_is_free=True,
        )
        for sign in (1, -1)
    ),
    Case(
        "lift moving",
        drive("lift", velocity=math.nan),
        drive("left", velocity=9.0),
        "the lift's screw turns with nan rad/s",
        LINK,
        lift_is_free=True,
    ),
    *(
        Case(
            f"axis timeout: {name}",
            drive(name, received_at=START - DRIVE_LIMIT),
            drive(name, received_at=START - DRIVE_LIMIT + 1),
            f"{TITLES[name]} silent for 0.25 s, limit 0.25 s",
            LINK,
        )
        for name in TITLES
    ),
    *(
        Case(
            f"axis timeout: {name}",
            drive(name, received_at=NEVER_RECEIVED, **stated(None)),
            {},
            f"{TITLES[name]} has not reported yet",
            LINK,
        )
        for name in TITLES
    ),
    *(
        Case(
            f"{row}: {name}",
            follows(name, uncommanded=uncommanded, obeyed_at=START - DRIVE_LIMIT),
            follows(name, uncommanded=uncommanded, obeyed_at=START - DRIVE_LIMIT + 1),
            f"{MOVES[name]} for 0.25 s",
            LINK,
        )
        for name in TITLES
        for row, uncommanded in (("tracking error", False), ("uncommanded motion", True))
    ),
    Case(
        "uncommanded motion: left",
        follows("left", uncommanded=True, obeyed_at=START - DRIVE_LIMIT, set_point=Stop.STANDSTILL),
        {},
        f"{TITLES['left']}, commanded to stop, moves with 0.25 rad/s for 0.25 s",
        LINK,
    ),
    Case(
        "uncommanded motion: lift",
        follows("lift", uncommanded=True, obeyed_at=START - DRIVE_LIMIT, set_point=Homed()),
        follows("lift", uncommanded=True, obeyed_at=START - DRIVE_LIMIT + 1, set_point=Homed()),
        f"{TITLES['lift']}, homing, moves with 0.25 rad/s for 0.25 s",
        LINK,
    ),
    Case(
        "tracking error: steer",
        follows("steer", obeyed_at=START - DRIVE_LIMIT, set_point=Position(1.0)),
        {},
        f"{TITLES['steer']}, commanded to 1.000 rad, is at 0.125 rad for 0.25 s",
        LINK,
    ),
    *(
        Case(
            f"position not changing: {name}",
            follows(name, settled_at=START - DRIVE_LIMIT, place_at=START - DRIVE_LIMIT),
            follows(name, settled_at=START - DRIVE_LIMIT + 1, place_at=START - DRIVE_LIMIT),
            f"{MOVES[name]}: its position has not changed by a bit for 0.25 s",
            LINK,
        )
        for name in TITLES
    ),
    Case(
        "position not changing: left",
        follows("left", obeyed_at=START - DRIVE_LIMIT, place_at=START - DRIVE_LIMIT // 2),
        follows("left", obeyed_at=START - DRIVE_LIMIT + 1, place_at=START - DRIVE_LIMIT),
        f"{MOVES['left']}: its position has not changed by a bit for 0.12 s",
        LINK,
        also=("tracking error: left",),
    ),
    Case(
        "tracking error: left",
        follows("left", obeyed_at=START - DRIVE_LIMIT, place_at=START - DRIVE_LIMIT // 2 + 1),
        {},
        f"{MOVES['left']} for 0.25 s",
        LINK,
    ),
    Case(
        # Its backlog exists since it deviates.
        "tracking error: left",
        follows(
            "left",
            obeyed_at=START - DRIVE_LIMIT,
            settled_at=START - DRIVE_LIMIT,
            place_at=START - DRIVE_LIMIT,
        ),
        {},
        f"{MOVES['left']} for 0.25 s",
        LINK,
        also=("position not changing: left",),
    ),
    Case(
        # Its backlog exists since 100 ms.
        "tracking error: left",
        follows("left", obeyed_at=START - DRIVE_LIMIT, settled_at=START - BACKLOG, place_at=START - BACKLOG),
        follows(
            "left", obeyed_at=START - DRIVE_LIMIT + 1, settled_at=START - BACKLOG, place_at=START - BACKLOG
        ),
        f"{MOVES['left']} for 0.25 s",
        LINK,
    ),
    *(
        Case(
            "position not changing: left",
            follows("left", place_at=START - 2 * DRIVE_LIMIT) | drive("left", current_a=sign * above(10.0)),
            follows("left", place_at=START - 2 * DRIVE_LIMIT + late) | drive("left", current_a=sign * amps),
            f"{TITLES['left']} pulls with 10.0 A, and has not moved by a bit for 0.50 s",
            LINK,
        )
        for sign in (1, -1)
        for late, amps in ((0, 10.0), (1, 20.0))
    ),
    Case(
        "position not changing: left",
        follows("left", place_at=START - 2 * DRIVE_LIMIT) | drive("left", current_a=math.nan),
        follows("left", place_at=START - 2 * DRIVE_LIMIT) | drive("left", current_a=None),
        f"{TITLES['left']} pulls with nan A, and has not moved by a bit for 0.50 s",
        LINK,
    ),
    *(
        Case(
            "position not changing: left",
            follows("left", halted=True, place_at=START - HALTS),
            follows("left", halted=halted, place_at=START - HALTS + late),
            f"{MOVES['left']}: it turned, and 0.04 s later has not moved by a bit",
            LINK,
        )
        for halted, late in ((True, 1), (False, 0))
    ),
    *(
        Case(
            f"reference lost: {name}",
            drive(name, reference_lost=True),
            {},
            f"{TITLES[name]}: its reference is lost, position unknown",
        )
        for name in ("steer", "lift")
    ),
    Case(
        "reference lost: steer",
        drive("steer", reference_lost=True) | {"stood": {"steer": "12.50 deg", "lift": "0.10 m"}},
        drive("left", reference_lost=True),
        f"{TITLES['steer']}: its reference is lost, position unknown (last known: 12.50 deg)",
    ),
    Case(
        "axis timeout: steer",
        drive("steer", received_at=NEVER_RECEIVED, reference_lost=True, **stated(None)),
        drive("right", reference_lost=True),
        f"{TITLES['steer']} has not reported yet",
        LINK,
    ),
    *(
        Case(
            f"axis fault: {name}",
            drive(name, fault="0x8611"),
            drive(name, fault=""),
            f"{TITLES[name]} reports fault 0x8611",
        )
        for name in TITLES
    ),
    Case("axis fault: steer", drive("steer", fault="0x0001"), {}, f"{TITLES['steer']} reports fault 0x0001"),
    *(
        Case(
            f"axis fault: {name}",
            drive(name, **stated(state)),
            {},
            f"{TITLES[name]} is in fault, code unknown",
        )
        for name, state in (
            ("left", PowerState.FAULT),
            ("right", PowerState.FAULT_REACTION_DISABLED),
            ("lift", PowerState.FAULT_REACTION_ENABLED),
        )
    ),
    Case(
        "axis reconfigured: steer",
        drive("steer", rewritten="603#2316100100000000"),
        drive("steer", rewritten=""),
        f"{TITLES['steer']}: someone else has written to it, 603#2316100100000000",
    ),
    *(
        Case(
            f"axis not enabled: {name}",
            drive(name, **stated(state)),
            {},
            f"{TITLES[name]} is not enabled: {state.title if state else 'state unknown'}",
        )
        for name, state in (
            ("left", None),
            ("right", PowerState.START),
            ("steer", PowerState.NOT_READY_TO_SWITCH_ON),
            ("lift", PowerState.SWITCH_ON_DISABLED),
            ("left", PowerState.READY_TO_SWITCH_ON),
            ("right", PowerState.SWITCHED_ON),
            ("steer", PowerState.REFRESH),
            ("lift", PowerState.MEASURE_INIT),
            ("left", PowerState.QUICK_STOP_ACTIVE),
        )
    ),
)
