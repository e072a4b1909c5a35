"""Drives watched: controlwords, statuswords, targets, modes, and what they say about power and movement."""

from typing import Final

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState, Status
from firmware_bridge.canopen.pdo import SYNCHRONOUS
from firmware_bridge.explain import kinds
from firmware_bridge.explain.bus_state import NEAR, BusState
from firmware_bridge.explain.drive_state import FAULTS, STATE_BITS
from firmware_bridge.explain.followed import Objects, Pdo
from firmware_bridge.explain.incident import IncidentKind, Report
from firmware_bridge.explain.motion import Standstill
from firmware_bridge.explain.node_state import NodeState
from firmware_bridge.explain.reasons import reasons_of
from firmware_bridge.units import SECOND, Nanoseconds, to_seconds

_BACK: Final = "operation enabled again"
_ENDED_BY_ENABLE: Final = (
    kinds.FAULT,
    kinds.QUICK_STOP,
    kinds.LOST_ENABLE,
    kinds.NMT_WHILE_ENABLED,
    kinds.EMERGENCY,
    kinds.STUCK,
)
_COMMANDS: Final = frozenset({od.CONTROLWORD, od.MODE})
_BITS: Final = int(Status.FOLLOWING_ERROR | Status.INTERNAL_LIMIT) | STATE_BITS
_FOLLOWING_TEXT: Final = "following error"
_FrameBytes = tuple[int, bytes]


class Drives:
    """The drives of one bus."""

    def __init__(self, bus: BusState) -> None:
        self._bus = bus
        self._deferred: list[tuple[IncidentKind, Nanoseconds, int, Report]] = []
        """What an emergency that follows shortly would explain."""

    # Written

    def received(self, at: Nanoseconds, address: int, payload: bytes, pdo: Pdo) -> None:
        """Take a receive PDO."""
        node = self._bus.node(pdo.node)
        node.address(at, address, payload)
        drive = node.drive
        if pdo.invalid and pdo.known:
            drive.invalid_pdo = (self._bus.evidence(at, address, payload), pdo.title, pdo.parameter)
            self._command_in_vain(at, node)
            return
        if node.network in {NmtState.PRE_OPERATIONAL, NmtState.STOPPED}:
            if drive.ignored_pdo is None:
                drive.ignored_pdo = self._bus.evidence(at, address, payload)
            self._command_in_vain(at, node)
            return
        drive.ignored_pdo = drive.invalid_pdo = None
        if pdo.known and len(payload) < pdo.size:
            self._wrong_length(at, address, payload, pdo)
        if pdo.transmission in SYNCHRONOUS and pdo.known:
            drive.waits_for_sync, drive.sync_since = (
                pdo.title,
                drive.sync_since and bool(drive.waits_for_sync),
            )
        self.written(at, address, payload, node, pdo.objects(payload))

    def written(
        self, at: Nanoseconds, address: int, payload: bytes, node: NodeState, objects: Objects
    ) -> None:
        """Take objects that are written to a drive."""
        drive = node.drive
        if all(
            drive.controlword == value if one == od.CONTROLWORD else drive.values.get(one) == value
            for one, value in objects
        ):
            return
        self._judge(node, at)
        control = None
        for one, value in objects:
            if one == od.CONTROLWORD:
                control = value
            else:
                drive.write(at, one, value)
        if control is not None and control != drive.controlword:
            drive.control = self._bus.evidence(at, address, payload)
            if drive.control_with(at, control) is not None and drive.expected_state is not None:
                drive.no_transition = (drive.control, control, drive.expected_state)
        node.motion.after_command(at)

    def _command_in_vain(self, at: Nanoseconds, node: NodeState) -> None:
        """Count a set-point that the node does not take as a command: a span without movement begins."""
        node.in_vain_since = at if node.in_vain_since is None else node.in_vain_since
        node.in_vain_at = at

    def _wrong_length(self, at: Nanoseconds, address: int, payload: bytes, pdo: Pdo) -> None:
        what = f"{pdo.title} has {len(payload)} bytes, its mapping {pdo.size}"
        evidence = self._bus.evidence(at, address, payload)
        self._bus.open(
            kinds.WRONG_LENGTH, at, Report(what=what, evidence=evidence, node=pdo.node, detail=address)
        )

    # Reported

    def sent(self, at: Nanoseconds, address: int, payload: bytes, pdo: Pdo) -> None:
        """Take a transmit PDO."""
        node = self._bus.node(pdo.node)
        node.sent += 1
        node.sent_at = at
        if pdo.known and len(payload) != pdo.size:
            self._wrong_length(at, address, payload, pdo)
            return
        for one, value in pdo.objects(payload):
            self.reported(at, node, one, value, (address, payload))

    def reported(
        self, at: Nanoseconds, node: NodeState, one: Address, value: int, frame: _FrameBytes
    ) -> None:
        """Take an object that a drive reports."""
        if one == od.STATUSWORD:
            if value != node.status_raw:
                self._status(at, node, value, frame)
            return
        values = node.drive.values
        if one == od.CONTROLWORD or (one in values and values[one] == value):
            return
        values[one] = value
        if one == od.POSITION_ACTUAL:
            node.motion.report(at, value, None)
        elif one == od.VELOCITY_ACTUAL:
            node.motion.report(at, None, value)

    def _status(self, at: Nanoseconds, node: NodeState, value: int, frame: _FrameBytes) -> None:
        before, drive = node.status_raw, node.drive
        node.status_raw = value
        old = drive.state
        if (before ^ value) & _BITS or before < 0:
            self._judge(node, at)
        drive.report_status(value)
        node.motion.after_command(at)
        if before >= 0 and not (before ^ value) & _BITS:
            return
        if drive.state is not old:
            self._state(at, node, old, frame)
        self._bits(at, node, value, max(before, 0), frame)

    def _state(self, at: Nanoseconds, node: NodeState, old: PowerState | None, frame: _FrameBytes) -> None:
        state, number = node.drive.state, node.node
        if state is PowerState.OPERATION_ENABLED:
            self._bus.incidents.close(_ENDED_BY_ENABLE, at, number, _BACK)
            return
        if old is PowerState.OPERATION_ENABLED:
            node.left_at = at
            self._after_emergency(at, node)
        title = "no state of a drive" if state is None else state.title
        if state in FAULTS and old not in FAULTS:
            what = f"it went to {title}" if old is not None else f"it is in {title} from the beginning"
            self._defer(kinds.FAULT, at, node, what, frame)
        elif state is PowerState.QUICK_STOP_ACTIVE:
            self._quick_stop(at, node, frame)
        elif old is PowerState.OPERATION_ENABLED and state is not None and _still_commanded(node):
            self._defer(kinds.LOST_ENABLE, at, node, f"it went to {title}", frame)

    def _after_emergency(self, at: Nanoseconds, node: NodeState) -> None:
        """Add to an emergency what has followed it."""
        reported, state = self._bus.incidents.recent(kinds.EMERGENCY, at - NEAR, node.node), node.drive.state
        if reported is not None and at - reported.last_at <= NEAR and state is not None:
            after = to_seconds(at - reported.last_at) * 1000
            reported.consequence = (
                f"it was enabled, and went to {state.title} {after:.1f} ms later: it stops, and its power "
                "stage goes off"
            )

    def _quick_stop(self, at: Nanoseconds, node: NodeState, frame: _FrameBytes) -> None:
        if node.drive.command is not ControlwordCommand.QUICK_STOP:
            self._defer(kinds.QUICK_STOP, at, node, "it went to quick stop active", frame)
            return
        control = node.drive.control
        by = "" if control is None else f" ({control.frame} at {self._bus.instant(control.at)} s)"
        report = Report(
            what="it was commanded to quick stop",
            evidence=self._bus.evidence(at, *frame),
            node=node.node,
            causes=(f"the controller commanded it by its controlword{by}",),
            check="why the controller stopped it: its log at this instant",
        )
        self._bus.open(kinds.QUICK_STOP, at, report)

    def _bits(self, at: Nanoseconds, node: NodeState, value: int, before: int, frame: _FrameBytes) -> None:
        words = self._bus.reader.words(node.node)
        mode = words.mode_of(node.drive.mode or 0)
        follows = mode is not None and words.bit_13.get(mode) == _FOLLOWING_TEXT
        for bit, kind, counts in (
            (int(Status.FOLLOWING_ERROR), kinds.FOLLOWING_ERROR, follows and node.drive.enabled),
            (int(Status.INTERNAL_LIMIT), kinds.INTERNAL_LIMIT, node.drive.enabled),
        ):
            if value & bit and not before & bit and counts:
                report = Report(
                    what=f"statusword 0x{value:04X}",
                    evidence=self._bus.evidence(at, *frame),
                    node=node.node,
                )
                self._bus.open(kind, at, report)
            elif before & bit and not value & bit:
                self._bus.incidents.close((kind,), at, node.node, "the bit is 0 again")

    # Judged

    def _defer(
        self, kind: IncidentKind, at: Nanoseconds, node: NodeState, what: str, frame: _FrameBytes
    ) -> None:
        report = Report(what=what, evidence=self._bus.evidence(at, *frame), node=node.node)
        self._deferred.append((kind, at, node.node, report))

    def tick(self, now: Nanoseconds) -> None:
        """Report what no emergency has explained in the meantime."""
        due = [one for one in self._deferred if now - one[1] > NEAR]
        if due:
            self._deferred = [one for one in self._deferred if now - one[1] <= NEAR]
        for kind, at, number, report in due:
            node = self._bus.node(number)
            explained = node.emergency_at is not None and abs(at - node.emergency_at) <= NEAR
            if not explained and not self._bus.incidents.is_open(kinds.EMERGENCY, number):
                made = self._bus.open(kind, at, report)
                if node.drive.enabled:
                    self._bus.incidents.close((kind,), now, number, _BACK)
                made.at = at

    def synchronized(self) -> None:
        """Take a SYNC."""
        for node in self._bus.nodes.values():
            if node.drive.waits_for_sync:
                node.drive.sync_since = True

    def end(self, now: Nanoseconds) -> None:
        """Judge what the recording ends with."""
        self.tick(now + SECOND)
        for node in list(self._bus.nodes.values()):
            self._judge(node, now)
            self._judge_in_vain(node)

    def _judge(self, node: NodeState, at: Nanoseconds) -> None:
        standstill = node.motion.before_command(at)
        if standstill is not None:
            self._stuck(node, standstill)

    def _judge_in_vain(self, node: NodeState) -> None:
        since = node.in_vain_since
        in_vain = node.drive.invalid_pdo or node.drive.ignored_pdo
        if since is not None and in_vain and node.seen:
            self._stuck(node, Standstill(since, node.in_vain_at, node.motion.ever_moved, observed=False))

    def _stuck(self, node: NodeState, standstill: Standstill) -> None:
        reasons = reasons_of(node.drive)
        if not reasons and not standstill.observed:
            return
        incidents = self._bus.incidents
        fault = any(incidents.is_open(kind, node.node) for kind in (kinds.EMERGENCY, kinds.FAULT))
        # A drive that has reported why it stopped needs no second explanation.
        if fault and (standstill.had_moved or incidents.is_open(kinds.EMERGENCY, node.node)):
            return
        more = "does not move any more" if standstill.had_moved else "does not move"
        length = to_seconds(standstill.until - standstill.since)
        texts = tuple(reason.text(node.drive) for reason in reasons)
        report = Report(
            what=f"it is commanded and {more} for {length:.1f} s" + (f": {texts[0]}" if texts else ""),
            evidence=reasons[0].evidence(node.drive) if reasons else node.drive.control,
            node=node.node,
            detail=reasons[0].name if reasons else "",
            causes=texts,
            check=reasons[0].remedy if reasons else "",
        )
        incidents.open(kinds.STUCK, standstill.since, report)


def _still_commanded(node: NodeState) -> bool:
    """Return whether the last controlword wants the power that the drive has left."""
    return node.drive.command is ControlwordCommand.ENABLE_OPERATION and node.reset_at is None
