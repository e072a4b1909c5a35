"""Faults of a random run, and the way in which they are drawn."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from typing import Any, Final

from numpy.random import Generator

from emulators.bench.faults import Fault
from emulators.bench.faults.people import BridgeEnds
from firmware_bridge.units import NEVER

LIES_S: Final = 12.0
"""The longest lie: well beyond the time in which the bridge must have stopped the lying device."""


class FaultProfile(Enum):
    """Trustworthiness of the devices while a fault is on."""

    HONEST = "honest"
    """A device fails, and none lies."""
    LYING = "lying"
    """A drive sends false reports, or does not execute its commands."""
    FOREIGN_NODE = "foreign"
    """Another master speaks on the bus."""


How = Callable[[Generator], dict[str, Any]]


@dataclass(frozen=True, slots=True)
class Failing:
    """The way in which a fault is drawn."""

    fault_profile: FaultProfile
    how: How = lambda _: {}
    longest_s: float = 1.0
    disables_power: bool = True
    """The drives may lose their power by it: on a slope no one holds that, so it is not drawn there."""


def _ends(chance: Generator) -> dict[str, Any]:
    """Ctrl-C, and once more within 5 s or not; or the process is killed."""
    if chance.random() < 0.4:
        return {"how": "killed"}
    again = {"again_after_s": round(float(chance.uniform(0.05, 4.9)), 3)}
    return {"how": "interrupted", **(again if chance.random() < 0.5 else {})}


def _joins(chance: Generator) -> dict[str, Any]:
    orders = ["", "take", "give up", "arm", "disarm", "emergency stop", "clear", "hold", "garbage"]
    order = str(chance.choice(orders))
    # Under the first one's name it gives no order: an answer's addressee would be ambiguous.
    system = 255 if order in {"", "garbage"} and chance.random() < 0.5 else 254
    stick = float(chance.choice([-1.0, 0.0, 0.0, 1.0]))
    return {"order": order, "stick": stick, "system": system}


def _master(chance: Generator) -> dict[str, Any]:
    """SYNC, the bridge's own heartbeat, a drive's set-points (without power, enabled, moving); its objects.

    By SDO: controlword without power and enabled, a speed, a profile's deceleration, no watch.
    """
    node = int(chance.integers(1, 5))
    sent = [
        (0x080, ""),
        (0x764, "05"),
        (0x500 + node, "060000000000"),
        (0x500 + node, "0F00E8030000"),
        (0x400 + node, "060000000000"),
        (0x400 + node, "3F0010270000"),
        (0x600 + node, "2B40600006000000"),
        (0x600 + node, "2B4060000F000000"),
        (0x600 + node, "23FF6000E8030000"),
        (0x600 + node, "2384600001000000"),
        (0x600 + node, "2316100100000000"),
    ]
    identifier, data = sent[int(chance.integers(len(sent)))]
    return {"identifier": identifier, "data": data, "every_ms": int(chance.choice([5, 20, 50, 200]))}


def _share(chance: Generator) -> dict[str, Any]:
    return {"share": round(float(chance.choice([0.05, 0.3, 1.0])), 3)}


FAILING: Final[dict[str, Failing]] = {
    "frame_error": Failing(FaultProfile.HONEST, _share),
    "frame_loss": Failing(FaultProfile.HONEST, _share),
    "receive_overrun": Failing(FaultProfile.HONEST, _share),
    "bus_off": Failing(FaultProfile.HONEST),
    "babbling_node": Failing(
        FaultProfile.HONEST, lambda chance: {"every_us": int(chance.integers(150, 2000))}
    ),
    "node_silent": Failing(FaultProfile.HONEST, longest_s=3.0),
    "drive_restart": Failing(FaultProfile.HONEST),
    "supply_sag": Failing(FaultProfile.HONEST, lambda chance: {"to_v": float(chance.choice([5.0, 15.0]))}),
    "logic_supply_sag": Failing(FaultProfile.HONEST, lambda _: {"to_v": 3.0}),
    "gate_supply_sag": Failing(FaultProfile.HONEST, lambda _: {"to_v": 6.0}),
    "datagram_loss": Failing(FaultProfile.HONEST, _share, longest_s=8.0, disables_power=False),
    "datagram_late": Failing(
        FaultProfile.HONEST,
        lambda chance: {"by_ms": float(chance.integers(10, 1500))},
        longest_s=3.0,
        disables_power=False,
    ),
    "datagram_doubled": Failing(
        FaultProfile.HONEST,
        lambda chance: {"after_ms": float(chance.integers(0, 400))},
        longest_s=5.0,
        disables_power=False,
    ),
    "serial_unplugged": Failing(FaultProfile.HONEST, longest_s=3.0),
    "bridge_ends": Failing(FaultProfile.HONEST, _ends, longest_s=8.0),
    "bridge_suspended": Failing(FaultProfile.HONEST, longest_s=5.0),
    "second_bridge": Failing(FaultProfile.HONEST, longest_s=5.0, disables_power=False),
    "second_station": Failing(FaultProfile.HONEST, _joins, longest_s=14.0, disables_power=False),
    "board_silent": Failing(FaultProfile.HONEST, longest_s=5.0),
    "board_reset": Failing(FaultProfile.HONEST),
    "board_hangs": Failing(FaultProfile.HONEST),
    "board_brown_out": Failing(FaultProfile.HONEST, longest_s=3.0),
    "board_unpowered": Failing(FaultProfile.HONEST, longest_s=3.0),
    "body_hidden": Failing(FaultProfile.HONEST, longest_s=6.0, disables_power=False),
    "capture_late": Failing(
        FaultProfile.HONEST,
        lambda chance: {"by_ms": float(chance.integers(5, 1500))},
        longest_s=5.0,
        disables_power=False,
    ),
    "capture_loss": Failing(FaultProfile.HONEST, _share, longest_s=5.0, disables_power=False),
    "imu_frozen": Failing(FaultProfile.LYING, longest_s=LIES_S, disables_power=False),
    "imu_axes_swapped": Failing(FaultProfile.LYING, longest_s=LIES_S, disables_power=False),
    "imu_silent": Failing(FaultProfile.HONEST, longest_s=5.0, disables_power=False),
    # A motor that does not follow its command; let go again it jumps to its command of then.
    "shaft_blocked": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "motor_cable_off": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "grip_lost": Failing(FaultProfile.HONEST, disables_power=False),
    "body_shakes": Failing(FaultProfile.HONEST, longest_s=5.0, disables_power=False),
    "load_lifted": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "motor_supply_sag": Failing(
        FaultProfile.LYING, lambda chance: {"to_v": float(chance.choice([2.0, 4.0]))}, longest_s=LIES_S
    ),
    "encoder_cable_off": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "motor_leads_swapped": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "board_chatters": Failing(
        FaultProfile.HONEST, lambda chance: {"every_ms": int(chance.choice([5, 20, 50]))}, longest_s=12.0
    ),
    "i2c_stuck": Failing(FaultProfile.HONEST, longest_s=3.0),
    "shield_absent": Failing(FaultProfile.HONEST, longest_s=3.0),
    "line_garbage": Failing(
        FaultProfile.LYING, lambda chance: {"every_ms": int(chance.choice([2, 20, 300]))}, longest_s=5.0
    ),
    "markers_swapped": Failing(
        FaultProfile.LYING,
        lambda chance: {
            "aside_m": round(float(chance.uniform(-1.0, 1.0)), 3),
            "turn_deg": float(chance.integers(-180, 181)),
        },
        longest_s=LIES_S,
        disables_power=False,
    ),
    "set_points_ignored": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "encoder_frozen": Failing(FaultProfile.LYING, longest_s=LIES_S),
    "encoder_cut": Failing(FaultProfile.LYING),
    "encoder_counts_lost": Failing(FaultProfile.LYING, lambda _: {"share": 0.2}, longest_s=5.0),
    "nmt_foreign_node": Failing(
        FaultProfile.FOREIGN_NODE,
        lambda chance: {
            "command": str(
                chance.choice(["stop", "enter_pre_operational", "reset_communication", "reset_node"])
            )
        },
    ),
    "stray_frames": Failing(FaultProfile.FOREIGN_NODE, _master, longest_s=LIES_S),
}
"""Profiles by the faults' names; those that are not here have no place in a random run."""


def disables_power(fault: Fault) -> bool:
    """Return whether the drives may lose their power by this fault, whatever the bridge does."""
    return FAILING[fault.kind].disables_power and not _requested(fault)


def _requested(fault: Fault) -> bool:
    """Return True for a bridge with one request to end, which holds a robot on a slope, and may."""
    once = isinstance(fault, BridgeEnds) and fault.how == "interrupted" and fault.again_after_s is None
    return once and fault.end == NEVER
