"""The traffic of a bus watched: its load, identifiers that come too often, SYNC, errors of the controller."""

from collections import deque
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia402 import ControlwordBit
from firmware_bridge.explain import kinds
from firmware_bridge.explain.bus_state import BusState
from firmware_bridge.explain.followed import Objects, Pdo, frame_text
from firmware_bridge.explain.incident import Evidence, Report
from firmware_bridge.explain.node_state import Rhythm
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds
from firmware_bridge.wire.can import ERROR, INTERFRAME_BITS, MAX_PAYLOAD, frame_bits
from firmware_bridge.wire.can_error import BUS_OFF, RESTARTED, error_text

SPAN: Final[Nanoseconds] = 100 * MILLISECOND
"""Rates and load are those of one such span."""
FULL: Final = 0.9
"""Load of a bus that is nearly full."""
TAKEN: Final = 0.6
"""Part of the frames that an identifier has which takes the bus."""
BUSY: Final = 0.25
"""Load below which no identifier takes the bus."""
TIMES: Final = 5
"""So many times its usual rate an identifier comes too often."""
QUIET: Final[Nanoseconds] = 300 * MILLISECOND
SYNC_MISSED: Final = 5.0
"""SYNC has stopped after so many of its periods without one."""
SET_POINTS: Final = 16
"""Set-points of one drive that are compared."""
ALTERNATING: Final = 4
"""So many contradictions among them are of two senders."""
LEAST: Final = 50
PART: Final = 10
"""Set-points of one sender that go back and forth differ by less than `LEAST`, or than a tenth."""
_CHANGES: Final = int(
    ControlwordBit.NEW_SETPOINT
    | ControlwordBit.CHANGE_IMMEDIATELY
    | ControlwordBit.RELATIVE
    | ControlwordBit.FAULT_RESET
)
"""Controlword bits that one sender sets and clears again."""
_BITS: Final = tuple(
    # Of a payload that is neither all zeros nor all ones: a mean number of stuff bits.
    frame_bits(0x2A5, bytes((0x53, 0x10, 0x00, 0x27, 0x00, 0xC1, 0x08, 0x31)[:length])) + INTERFRAME_BITS
    for length in range(MAX_PAYLOAD + 1)
)


class Traffic:
    """The traffic of one bus."""

    def __init__(self, bus: BusState) -> None:
        self._bus = bus
        self._counts: dict[int, int] = {}
        self._bits = 0
        self._usual: dict[int, float] = {}
        self._spans = 0
        self._first: dict[int, Evidence] = {}
        self._sync = Rhythm()
        self._sync_gone = False
        self._set_points: dict[int, tuple[deque[bytes], deque[bool]]] = {}

    def count(self, address: int, length: int) -> None:
        """Count a frame."""
        counts = self._counts
        counts[address] = counts.get(address, 0) + 1
        self._bits += _BITS[length]

    def first(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take the first frame of an identifier."""
        if not address & ERROR:
            self._first[address] = self._bus.evidence(at, address, payload)

    def tick(self, now: Nanoseconds, spans: int) -> None:
        """Judge the span that is over; `spans` have passed, the others without a frame."""
        load = self._bits * SECOND / SPAN / self._bus.bit_rate
        frames = sum(self._counts.values())
        if load > BUSY and frames:
            self._judge(now, load, frames)
        self._learn(spans)
        self._counts.clear()
        self._bits = 0
        self._sync_overdue(now)
        incidents = self._bus.incidents
        incidents.quiet_since(kinds.BABBLING, now - QUIET, "the identifier has its usual rate again")
        incidents.quiet_since(kinds.BUS_LOAD, now - QUIET, "the load is lower again")
        incidents.quiet_since(kinds.ERROR_FRAMES, now - SECOND, "no more reports for 1 s")
        incidents.quiet_since(kinds.SECOND_PRODUCER, now - 2 * SECOND, "it has its usual rate again")

    def _learn(self, spans: int) -> None:
        self._spans += spans
        for address, count in self._counts.items():
            # Part of all frames of before, as the mean of a span.
            self._usual[address] = self._usual.get(address, 0.0) + count

    def _judge(self, now: Nanoseconds, load: float, frames: int) -> None:
        address, count = max(self._counts.items(), key=lambda one: one[1])
        usual = self._usual.get(address, 0.0) / max(self._spans, 1)
        percent = f"{100 * min(load, 1.0):.0f} % of the bus"
        if count > TAKEN * frames and count > TIMES * usual and not address & ERROR:
            name = frame_text(address, b"").partition("#")[0]
            report = Report(
                what=f"{name} comes {count * SECOND // SPAN} times a second, and takes most of {percent}",
                evidence=self._first.get(address),
                detail=address,
                check=f"which node sends {name}; unplug it",
            )
            self._bus.open(kinds.BABBLING, now - SPAN, report).last_at = now
        elif load > FULL:
            what = f"{percent} at {self._bus.bit_rate} bit/s"
            self._bus.open(kinds.BUS_LOAD, now - SPAN, Report(what=what)).last_at = now

    # SYNC

    def sync(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take a SYNC."""
        gap = self._sync.take(at)
        if self._sync_gone:
            self._sync_gone = False
            text = f"SYNC is back after {to_seconds(gap):.2f} s"
            self._bus.incidents.close((kinds.SYNC_GAP,), at, None, text)
        if self._sync.doubled and self._sync.period is not None:
            mean = sum(self._sync.gaps) // len(self._sync.gaps) / MILLISECOND
            what = f"SYNC comes every {mean:.1f} ms, not every {self._sync.period / MILLISECOND:.1f} ms"
            evidence = self._bus.evidence(at, address, payload)
            self._bus.open(kinds.SECOND_PRODUCER, at, Report(what=what, evidence=evidence, detail=address))

    def _sync_overdue(self, now: Nanoseconds) -> None:
        last, period = self._sync.last_at, self._sync.period
        if self._sync_gone or last is None or period is None or not self._sync.overdue(now, SYNC_MISSED):
            return
        if not any(node.drive.enabled for node in self._bus.nodes.values()):
            return
        self._sync_gone = True
        report = Report(
            what=f"no SYNC, whose period was {period / MILLISECOND:.1f} ms, while drives are enabled",
            evidence=self._bus.evidence(last, cia301.SYNC, b""),
        )
        self._bus.open(kinds.SYNC_GAP, last + int(SYNC_MISSED * period), report)

    # Set-points of two senders

    def set_point(self, at: Nanoseconds, address: int, payload: bytes, pdo: Pdo) -> None:
        """Take a receive PDO: set-points of two senders alternate, and differ by more than a regulator's."""
        known = self._set_points.get(address)
        if known is None:
            known = self._set_points[address] = (deque(maxlen=2), deque(maxlen=SET_POINTS))
        last, contradictions = known
        other = last[-1] if last else payload
        returns = other != payload == last[0]
        last.append(payload)
        contradictions.append(returns and _contradict(pdo.objects(payload), pdo.objects(other)))
        if contradictions[-1] and sum(contradictions) >= ALTERNATING:
            name = frame_text(address, b"").partition("#")[0]
            report = Report(
                what=f"{pdo.title} of node {pdo.node} alternates between {frame_text(address, other)} and "
                f"{frame_text(address, payload)}",
                evidence=self._bus.evidence(at, address, other),
                node=pdo.node,
                detail=address,
                check=f"which program beside the controller sends {name}",
            )
            self._bus.open(kinds.SECOND_PRODUCER, at, report)

    # Errors of the interface

    def error(self, at: Nanoseconds, address: int, payload: bytes) -> None:
        """Take an error report of the CAN interface."""
        incidents = self._bus.incidents
        evidence = self._bus.evidence(at, address, payload)
        if address & BUS_OFF & ~ERROR:
            self._bus.open(kinds.BUS_OFF, at, Report(what="bus off", evidence=evidence))
        elif address & RESTARTED & ~ERROR:
            incidents.close((kinds.BUS_OFF, kinds.ERROR_FRAMES), at, None, "the interface was restarted")
        else:
            report = Report(what=error_text(address, payload), evidence=evidence)
            self._bus.open(kinds.ERROR_FRAMES, at, report)


def _contradict(one: Objects, other: Objects) -> bool:
    """Return whether two set-points cannot be those of one sender that goes from cycle to cycle."""
    for (address, first), (_, second) in zip(one, other, strict=False):
        if address == od.CONTROLWORD:
            if (first ^ second) & ~_CHANGES:
                return True
        elif abs(first - second) > max(LEAST, abs(first) / PART, abs(second) / PART):
            return True
    return False
