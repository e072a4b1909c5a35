"""Faults that end by themselves, or that nothing has to stop for: what holds, and that it drives again."""

from collections.abc import Mapping
from typing import Any, Final

from hil_tests.failures.causes import BOARDS, CAN, SERIAL, Cause, Fault, fault

HEARTBEAT_LOST: Final = 0x8130
PASSIVE: Final = 0x8120
OVERRUN: Final = 0x8110
WAS_OFF_THE_BUS: Final = 0x81FD
"""Error codes (EPOS2 Firmware Specification, chapter 9)."""

Codes = Mapping[str, tuple[int, ...]]
AXES: Final = ("left", "right", "steer", "lift")
ROME: Final = BOARDS["rome"]


def _row(name: str, what: Fault, *events: str, **row: Any) -> Cause:
    return Cause(name=name, fault=what, interlock_events=events, **{"lines": CAN, **row})


def _ignored(name: str, what: Fault) -> Cause:
    return _row(name, what, only=True, codes={})


def _silent(*axes: str) -> tuple[str, ...]:
    return tuple(f"axis timeout: {axis}" for axis in axes)


def _all(*codes: int) -> Codes:
    return dict.fromkeys(AXES, codes)


def _commanded(command: str) -> Cause:
    """Have a second controller command one drive."""
    events = ("axis not enabled: left", "second controller: drives", "not armed")
    # One that is only not operational is made so again before it counts as silent.
    silent = _silent("left") if command.startswith("reset") else ()
    what = fault("nmt_foreign_node", command=command, node="left")
    return _row(
        f"a second controller's NMT {command} to a drive", what, *events, *silent, codes={}, again=True
    )


def _one_drive(name: str, kind: str, *codes: int, **keys: Any) -> Cause:
    what = fault(kind, node="right", for_s=0.3, **keys)
    return _row(name, what, "axis fault: right", codes={"right": codes}, again=True)


_WRONG_WAY: Final = ("uncommanded motion", "tracking error", "position not changing")
TEMPORARY: Final = (
    # The bus: each damaged frame costs 8, each good one gives 1 back; above one in nine the counters climb.
    _ignored("one frame in twenty damaged", fault("frame_error", share=0.05, for_s=2.0)),
    _row(
        "every other frame damaged for 2 s",
        fault("frame_error", share=0.5, for_s=2.0),
        "not armed",
        reports=("axis fault",),
    ),
    _row("all frames damaged for 0.4 s", fault("frame_error", for_s=0.4), *_silent(*AXES)),
    _row(
        "steering's frames lost for 0.4 s",
        fault("frame_loss", node=3, for_s=0.4),
        *_silent("steer"),
        "not armed",
        only=True,
        codes={},
        again=True,
    ),
    _ignored("a third of steering's frames lost", fault("frame_loss", node="steer", share=0.3, for_s=2.0)),
    _row(
        "bridge's frames lost for 0.5 s",
        fault("frame_loss", node="bridge", for_s=0.5),
        *_silent(*AXES),
        codes=_all(HEARTBEAT_LOST),
    ),
    _row(
        "a bad plug at one drive for 0.5 s",
        fault("reception_error", node="left", for_s=0.5),
        *_silent("left"),
        codes={"left": (HEARTBEAT_LOST, PASSIVE)},
    ),
    _row(
        "one drive too slow for its frames for 0.1 s",
        fault("receive_overrun", node="left", for_s=0.1),
        "axis fault: left",
        codes={"left": (OVERRUN,)},
        again=True,
    ),
    _row(
        "one drive off the bus for 0.5 s",
        fault("bus_off", node="right", for_s=0.5),
        *_silent("right"),
        codes={"right": (HEARTBEAT_LOST, WAS_OFF_THE_BUS, PASSIVE)},
    ),
    _row(
        "cable cut behind one drive for 0.5 s",
        fault("can_cut", between=["left", "right"], for_s=0.5),
        *_silent("right", "steer", "lift"),
        codes=dict.fromkeys(AXES[1:], (HEARTBEAT_LOST,)),
        again=True,
    ),
    _row(
        "one drive alone behind a cut for 0.5 s",
        fault("can_cut", between=[4, "steer"], for_s=0.5),
        *_silent("lift"),
        codes={"lift": (HEARTBEAT_LOST, PASSIVE)},
    ),
    _row("wires swapped for 0.5 s", fault("can_swapped", node="lift", for_s=0.5), *_silent(*AXES)),
    _ignored("a node that babbles every 200 us", fault("babbling_node", every_us=200, for_s=1.0)),
    _row(
        "a node that babbles every 100 us for 0.5 s",
        fault("babbling_node", every_us=100, for_s=0.5),
        *_silent(*AXES),
        codes=_all(HEARTBEAT_LOST),
    ),
    _row(
        "bridge off both its links for 0.7 s",
        fault("node_silent", node="bridge", for_s=0.7),
        "operator link timeout",
        *_silent(*AXES),
        codes=_all(HEARTBEAT_LOST),
        again=True,
    ),
    *map(_commanded, ("stop", "enter_pre_operational", "reset_node", "reset_communication")),
    *(
        _row(
            f"a second controller's NMT {command} to all",
            fault("nmt_foreign_node", command=command),
            # The bridge makes them listen again, within the silence that it allows or just after.
            *(f"axis not enabled: {axis}" for axis in AXES),
            codes={},
        )
        for command in ("stop", "enter_pre_operational", "reset_communication")
    ),
    # Drives.
    _row(
        "one drive restarts for 0.2 s",
        fault("drive_restart", node="left", for_s=0.2),
        "axis not enabled: left",
        codes={},
        again=True,
    ),
    _row(
        "supply at 9 V for 0.2 s", fault("supply_sag", to_v=9.0, for_s=0.2), "not armed", codes=_all(0x3220)
    ),
    _ignored("supply at 14 V", fault("supply_sag", to_v=14.0, for_s=2.0)),
    _one_drive("a drive's supply at 9.9 V", "supply_sag", 0x3220, to_v=9.9),
    _one_drive("a drive's supply at 80 V", "supply_surge", 0x3210, to_v=80.0),
    _one_drive("a drive's logic supply at 4 V", "logic_supply_sag", 0x5113, to_v=4.0),
    _one_drive("a drive's gate supply at 4 V", "gate_supply_sag", 0x5114, to_v=4.0),
    _one_drive("a drive at 120 degrees", "overheating", 0x4210, to_celsius=120.0),
    _one_drive("an encoder's cable out for 0.3 s", "encoder_cut", 0xFF0A),
    _one_drive("an encoder's channels swapped for 0.3 s", "encoder_swapped", 0xFF03),
    _one_drive("one count in twenty lost for 0.3 s", "encoder_counts_lost", 0xFF03, share=0.05),
    _one_drive("no index for 0.3 s", "index_missing", 0xFF02),
    _one_drive("index pulses where there are none", "index_spurious", 0xFF03, 0xFF02),
    # The operator's link.
    _row(
        "operator link dead for 1 s",
        fault("datagram_loss", for_s=1.0),
        "operator link timeout",
        "stick not neutral",
        only=True,
        codes={},
        again=True,
    ),
    _ignored("every datagram twice", fault("datagram_doubled", after_ms=20, for_s=8.0)),
    _row(
        "adapter unplugged for 1 s",
        fault("serial_unplugged", for_s=1.0),
        "link lost: drives",
        lines=SERIAL,
        again=True,
    ),
    # Boards.
    *(
        _row(name, what, "not armed", lines=ROME, reports=("position not changing", "tracking error"))
        for name, what in (
            ("a motor's cable off", fault("motor_cable_off", node="two")),
            ("a wheel blocked", fault("shaft_blocked", node="two")),
            ("motors' supply at 2 V", fault("motor_supply_sag", to_v=2.0)),
        )
    ),
    *(
        _row(name, fault(kind, node="two"), "not armed", lines=ROME, reports=_WRONG_WAY)
        for name, kind in (
            ("a motor's leads exchanged", "motor_leads_swapped"),
            ("a wheel's encoder channels exchanged", "encoder_swapped"),
        )
    ),
    _row(
        "adapter of an arm unplugged for 2 s",
        fault("serial_unplugged", for_s=2.0),
        "link lost: arm",
        *_silent("j1"),
        "axis restarted: j1",
        lines=BOARDS["ar2"],
    ),
)
