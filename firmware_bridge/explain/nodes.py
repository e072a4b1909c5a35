"""Nodes watched: network commands, boot-up, heartbeats, emergencies. Their transfers: `transfers`."""

from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.canopen.emergency import NO_ERROR
from firmware_bridge.explain import kinds
from firmware_bridge.explain.bus_state import BusState
from firmware_bridge.explain.incident import Report
from firmware_bridge.explain.node_state import NodeState
from firmware_bridge.explain.proofs import Proofs
from firmware_bridge.explain.remedies import remedy_of
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds

MISSED: Final = 3.0
"""A node is silent after so many of its periods without a heartbeat."""
RESET_WITHIN: Final[Nanoseconds] = 10 * SECOND
"""A boot-up message so long after a reset command is its answer."""
SCAN: Final = 8
"""So many nodes that never answer are a search for nodes."""
_STATES: Final = {
    NmtCommand.START: NmtState.OPERATIONAL,
    NmtCommand.STOP: NmtState.STOPPED,
    NmtCommand.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
}
_RESETS: Final = frozenset({NmtCommand.RESET_NODE, NmtCommand.RESET_COMMUNICATION})


class NodesWatch:
    """The nodes of one bus."""

    def __init__(self, bus: BusState, proofs: Proofs) -> None:
        self._bus = bus
        self._proofs = proofs

    # Network management and error control

    def command(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a network command."""
        decoded = cia301.decode_nmt(payload)
        if decoded is None:
            return
        command, number = decoded
        evidence = self._bus.evidence(at, address, payload)
        for node in [self._bus.node(number)] if number else list(self._bus.nodes.values()):
            if number:
                node.address(at, address, payload)
            if node.drive.enabled and command is not NmtCommand.START:
                title = command.name.lower().replace("_", " ")
                report = Report(what=f"NMT {title} while it is enabled", evidence=evidence, node=node.node)
                self._bus.open(kinds.NMT_WHILE_ENABLED, at, report)
            if command in _RESETS:
                node.reset_at = at
            elif not self._bus.is_controller(node.node):
                self._network(node, at, _STATES[command])
        if command in _RESETS:
            self._bus.reader.changed()

    def _network(self, node: NodeState, at: Nanoseconds, state: NmtState) -> None:
        node.network = node.drive.network = state
        if state is NmtState.OPERATIONAL:
            self._bus.incidents.close((kinds.RESTART,), at, node.node, "operational again")

    def guarded(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take the remote request of node guarding."""
        self._bus.node(address & cia301.NODE_MASK).address(at, address, payload)

    def beat(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a boot-up message, a heartbeat or the answer to node guarding."""
        node = self._bus.node(address & cia301.NODE_MASK)
        if payload == b"\0":
            self._boot(node, at, address, payload)
            return
        node.sent += 1
        node.sent_at = at
        gap = node.beats.take(at)
        period = node.beats.period
        if node.silent:
            node.silent = False
            self._proofs.heartbeat_back(node.node, at, gap)
            silence = f"its heartbeat is back after {to_seconds(gap):.2f} s"
            self._bus.incidents.close((kinds.SILENT, kinds.SILENT_CONTROLLER), at, node.node, silence)
        if period is not None and node.beats.doubled:
            self._twice(node, at, address, payload, period)
        if payload != node.beat:
            node.beat = payload
            state = cia301.decode_heartbeat(payload)
            if state is not None:
                self._network(node, at, state)

    def _twice(self, node: NodeState, at: Nanoseconds, address: int, payload: bytes, period: int) -> None:
        mean = sum(node.beats.gaps) // len(node.beats.gaps) // MILLISECOND
        report = Report(
            what=f"its heartbeat comes every {mean} ms, not every {period // MILLISECOND} ms",
            evidence=self._bus.evidence(at, address, payload),
            node=node.node,
            detail=address,
        )
        self._bus.open(kinds.SECOND_PRODUCER, at, report)

    def _boot(self, node: NodeState, at: Nanoseconds, address: int, payload: bytes) -> None:
        evidence = self._bus.evidence(at, address, payload)
        commanded = node.reset_at is not None and at - node.reset_at < RESET_WITHIN
        if node.sent and not commanded:
            was = (
                "enabled"
                if node.drive.enabled
                else "set up"
                if node.network is NmtState.OPERATIONAL
                else "on"
            )
            what = f"it has started again while it was {was}; no reset command was before"
            self._bus.open(kinds.RESTART, at, Report(what=what, evidence=evidence, node=node.node))
        if node.silent:
            self._bus.incidents.close((kinds.SILENT,), at, node.node, "it has started again")
        node.silent, node.reset_at, node.request = False, None, None
        node.booted, node.status_raw, node.beat = True, -1, b""
        node.beats.restart()
        node.drive.restart()
        node.motion.restart()
        node.network = node.drive.network = NmtState.PRE_OPERATIONAL
        self._bus.reader.changed()

    # Emergencies

    def emergency(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take an emergency message."""
        node = self._bus.node(address & cia301.NODE_MASK)
        node.sent += 1
        node.sent_at = at
        decoded = cia301.decode_emergency(payload)
        if decoded is None:
            return
        if decoded.code == NO_ERROR:
            self._bus.incidents.close(
                (kinds.EMERGENCY, kinds.FAULT), at, node.node, "EMCY 0x0000: no error is left"
            )
            return
        node.emergency_at = at
        remedy = remedy_of(decoded.code)
        title, _, text = self._bus.reader.emergency(node.node, payload).partition(": ")
        report = Report(
            what=f"EMCY {text or title}",
            evidence=self._bus.evidence(at, address, payload),
            node=node.node,
            detail=decoded.code,
            causes=(*self._seen_causes(at, decoded.code), *remedy.causes),
            consequence=self._power(node, at),
            check=f"{remedy.check}; reset: {remedy.reset}",
        )
        self._bus.open(kinds.EMERGENCY, at, report)

    def _power(self, node: NodeState, at: Nanoseconds) -> str:
        """Return what the frames show of the power stage; a change that follows replaces it."""
        drive = node.drive
        if drive.state is None:
            return ""
        if drive.enabled:
            return "it was enabled, and no change of its state was seen after it"
        passed = at - node.left_at
        left = f" {to_seconds(passed) * 1000:.0f} ms before" if node.left_at and passed < SECOND else ""
        return f"it went to {drive.state.title}{left}: no power" if left else f"it was in {drive.state.title}"

    def _seen_causes(self, at: Nanoseconds, code: int) -> tuple[str, ...]:
        """Return the causes of a lost connection that the frames show."""
        if code != 0x8130:  # noqa: PLR2004 - CiA 301: life guard or heartbeat
            return ()
        found = []
        for number, waits in self._bus.watched.items():
            last = self._bus.node(number).beats.last_at
            if last is None:
                continue
            silence = at - last
            if silence > waits // 2:
                found.append(f"the heartbeat of node {number} had stopped {to_seconds(silence):.2f} s before")
            elif self._bus.incidents.recent(kinds.SILENT_CONTROLLER, at - SECOND, number) is not None:
                found.append(f"the heartbeat of node {number} was missing shortly before")
            else:
                found.append(
                    f"the heartbeat of node {number} is in the recording all the time: it did not reach this "
                    "node, as behind a cut cable or a bad plug"
                )
        return tuple(found)

    # Time

    def tick(self, now: Nanoseconds) -> None:
        """Report nodes that are overdue."""
        for node in self._bus.nodes.values():
            if node.reset_at is not None and now - node.reset_at > RESET_WITHIN:
                node.reset_at = None
            if not node.silent and node.reset_at is None and node.beats.overdue(now, MISSED):
                self._silent(node)

    def _silent(self, node: NodeState) -> None:
        node.silent = True
        last, period = node.beats.last_at, node.beats.period
        if last is None or period is None:
            return
        controller = self._bus.is_controller(node.node)
        # One that has taken its consumers off before it ends has ended in order.
        if controller and node.node not in self._bus.watched:
            return
        kind = kinds.SILENT_CONTROLLER if controller else kinds.SILENT
        address = cia301.ERROR_CONTROL + node.node
        report = Report(
            what=f"no heartbeat after {to_seconds(last - (self._bus.first_at or 0)):.3f} s; its period was "
            f"{period // MILLISECOND} ms",
            evidence=self._bus.evidence(last, address, node.beat),
            node=node.node,
            causes=self._withheld(last, period) if controller else self._silent_causes(node, last, period),
        )
        self._bus.open(kind, last + int(MISSED * period), report)

    def _withheld(self, last: Nanoseconds, period: Nanoseconds) -> tuple[str, ...]:
        """Return a controller's causes: one whose requests go on lives."""
        drives = [one for one in self._bus.nodes.values() if not self._bus.is_controller(one.node)]
        speaks = any(one.answered is not None and one.answered.at > last + period for one in drives)
        # A drive whose state was not seen may have power.
        if not speaks or any(one.drive.state is None or one.drive.enabled for one in drives):
            return ()
        return (kinds.WITHHELD, *kinds.SILENT_CONTROLLER.causes)

    def _silent_causes(self, node: NodeState, last: Nanoseconds, period: Nanoseconds) -> tuple[str, ...]:
        if node.sent_at > last + period:
            return ("its producer heartbeat time 0x1017 was changed: other frames of it still come",)
        others = [
            one.node
            for one in self._bus.nodes.values()
            if one is not node
            and one.beats.last_at is not None
            and abs(one.beats.last_at - last) <= 2 * period
            and one.beats.overdue(self._bus.now, 1.5)
        ]
        if others:
            numbers = ", ".join(map(str, sorted(others)))
            return (
                f"the cable is cut or disturbed: node {numbers} went silent at the same time",
                "the supply of these nodes is out",
            )
        return kinds.SILENT.causes

    def end(self, now: Nanoseconds) -> None:
        """Report nodes that were commanded and never seen."""
        self.tick(now)
        absent = [node for node in self._bus.nodes.values() if node.addressed and not node.seen]
        if len(absent) > SCAN:
            return
        for node in absent:
            if node.first_to is not None:
                at, address, payload = node.first_to
                what = f"{node.addressed} frames to it, and none of it"
                evidence = self._bus.evidence(at, address, payload)
                self._bus.open(kinds.NO_NODE, at, Report(what=what, evidence=evidence, node=node.node))
