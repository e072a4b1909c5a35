"""A recording of serial lines explained: each line by itself, by the texts of its protocol's reader."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Final

from firmware_bridge.dissector.dissector import kinds as protocols
from firmware_bridge.dissector.protocols import Reader
from firmware_bridge.explain import line_kinds as kinds
from firmware_bridge.explain.explainer import Explained, Setup
from firmware_bridge.explain.incident import Incident, Incidents
from firmware_bridge.explain.line_exchange import Exchange, evidence
from firmware_bridge.explain.line_motion import Motion, counts_of
from firmware_bridge.explain.line_objects import Objects
from firmware_bridge.explain.line_source import BRIDGE, Chunk
from firmware_bridge.explain.line_texts import (
    BY_CHANCE,
    ECHOED,
    OBJECT_ANSWER,
    PART,
    UNKNOWN,
    Answer,
    Decoded,
    Role,
    answer_of,
    short,
)
from firmware_bridge.node import CAN, OPERATOR
from firmware_bridge.packet import Packet
from firmware_bridge.units import Nanoseconds

SAMPLE: Final = 2_000
"""Chunks by which the protocol of a line is found where nothing states it."""
WRONG: Final = 0.3
RIGHT: Final = 0.7
"""Shares of the device's texts that answer a request, with a wrong and with the right protocol."""
_NOT_LINES: Final = frozenset({CAN, OPERATOR})
_BETWEEN: Final = "; "
"""Between the texts of several commands in one chunk."""


class LineExplainer:
    """One line."""

    def __init__(self, reader: Reader, link: str, setup: Setup) -> None:
        self._reader = reader
        self._link = link
        self._incidents = Incidents(bus=f"line {link}", noun="motor")
        self._exchange = Exchange(self._incidents)
        self._motion = Motion(self._incidents)
        self.objects = Objects(setup, link)
        self._waiting: dict[bool, bytes] = {True: b"", False: b""}
        self._echo = b""

    @property
    def found(self) -> Sequence[Incident]:
        """The incidents of the line, and of the nodes behind it."""
        return (*self._incidents.found, *self.objects.found)

    def take(self, chunk: Chunk) -> None:
        """Take a chunk."""
        text = self._reader.read(
            chunk.link if chunk.by_device else BRIDGE, Packet(chunk.link, 0, chunk.payload)
        )
        payload = self._waiting[chunk.by_device] + chunk.payload
        texts = [one for one in text.split(_BETWEEN) if answer_of(one).role is not Role.NOTHING]
        if not texts:
            self._waiting[chunk.by_device] = payload[-1024:]
            return
        self._waiting[chunk.by_device] = b""
        for one in texts:
            decoded = Decoded(chunk.at, one, payload, len(texts) == 1)
            if chunk.by_device:
                self._received(decoded)
            else:
                self._requested(decoded)

    def _requested(self, decoded: Decoded) -> None:
        self._exchange.requested(decoded)
        self._motion.requested(decoded.at, decoded.text)
        self.objects.requested(decoded.at, decoded.text)

    def _received(self, decoded: Decoded) -> None:
        answer = answer_of(decoded.text)
        if answer.role is Role.RAW:
            self._raw(decoded)
            return
        self._exchange.taken(decoded)
        if answer.role in {Role.ANSWER, Role.OTHER}:
            self._answered(decoded, answer)
        elif answer.role is Role.BEGUN:
            self._motion.forget()
            self._exchange.begun(decoded, "it has started again")
        elif answer.role is Role.GARBAGE:
            self._exchange.garbage(decoded)
        elif answer.role is Role.REFUSAL:
            self._exchange.report(kinds.REFUSED, decoded, f"it refuses a request: {decoded.text}")
        else:
            self._exchange.report(kinds.CHATTER, decoded, f"it prints: {decoded.text}")

    def _raw(self, decoded: Decoded) -> None:
        """Take bytes without an end; the echo of a request has one."""
        self._exchange.taken(decoded)
        self._echo += decoded.payload
        if not self._echo.endswith(b"\r\n"):
            return
        text = self._echo.decode("latin-1").strip()
        self._echo = b""
        self._answered(decoded, Answer(Role.ANSWER, ECHOED, text))

    def _answered(self, decoded: Decoded, answer: Answer) -> None:
        request = self._exchange.answered(decoded, answer)
        if request is None:
            return
        self.objects.answered(decoded.at, answer.value)
        _, _, values = request.sent.text.partition(": ")
        for encoder, count in counts_of(request.name, values, answer.value):
            self._motion.counted(decoded.at, encoder, count, evidence(decoded))
        if self._motion.restarted:
            self._motion.restarted = False
            self._motion.forget()
            self._exchange.begun(decoded, "its counts begin at 0 by themselves: it has started again")

    def end(self, now: Nanoseconds) -> None:
        """Judge what the recording ends with."""
        self._exchange.end(now)
        self.objects.end(now)

    @property
    def answers(self) -> int:
        """Number of good answers."""
        return self._exchange.answers

    @property
    def requests(self) -> int:
        """Number of requests."""
        return self._exchange.requests


@dataclass(frozen=True, slots=True)
class Lines:
    """What is stated of the lines of a recording."""

    spoken: Mapping[str, str]
    """Protocols by the names of links, or of all by an empty name; for others all are tried."""
    setup: Setup
    link: str | None = None
    """Only this one; None: all."""


def explain_lines(chunks: Iterable[Chunk], lines: Lines) -> Explained:
    """Explain the chunks of a recording; of several lines each by itself, or one of them."""
    taken = [one for one in chunks if lines.link in {None, one.link}]
    by_link: dict[str, list[Chunk]] = {}
    for one in taken:
        by_link.setdefault(one.link, []).append(one)
    found: list[Incident] = []
    remarks: list[str] = []
    nodes: set[int] = set()
    for link, own in by_link.items():
        kind = _spoken(link, own, lines.spoken)
        if kind is None:
            remarks.append(f"line {link}: its protocol is not known; use --robot and --protocol")
            continue
        line = LineExplainer(protocols()[kind].reader(), link, lines.setup)
        for one in own:
            line.take(one)
        line.end(taken[-1].at)
        found += line.found
        nodes |= set(line.objects.nodes)
        remarks += line.objects.remarks
        remarks += _remarks(line, link, kind)
        remarks += _fits_better(link, kind, own)
    return Explained(
        tuple(sorted(found, key=lambda incident: incident.at)),
        len(taken),
        tuple(sorted(nodes)),
        taken[0].at if taken else 0,
        taken[-1].at if taken else 0,
        tuple(remarks),
        f"{len(by_link)} line{'' if len(by_link) == 1 else 's'}",
    )


def _remarks(line: LineExplainer, link: str, kind: str) -> Iterable[str]:
    if line.requests and not line.answers:
        yield (
            f"line {link}: {line.requests} requests and no answer that is known in the protocol {kind}: "
            "the device is not there, or it has another firmware or bit rate"
        )


def _spoken(link: str, own: Sequence[Chunk], stated: Mapping[str, str]) -> str | None:
    """Return the protocol of a line: as stated, as the device has recorded it, or the one that fits best."""
    known = next((one.spoken for one in own if one.spoken is not None), stated.get(link, stated.get("")))
    if known in protocols():
        return known
    scores = _scores(own)
    best = max(scores, key=lambda kind: scores[kind], default=None)
    return best if best is not None and scores[best] > 0 else None


def _scores(own: Sequence[Chunk]) -> Mapping[str, float]:
    return {kind: _score(kind, own[:SAMPLE]) for kind in protocols() if kind not in _NOT_LINES}


def _fits_better(link: str, kind: str, own: Sequence[Chunk]) -> Iterable[str]:
    """Yield a remark where another protocol fits a line that the stated one does not."""
    if _score(kind, own[:SAMPLE]) > WRONG:
        return
    scores = _scores(own)
    best = max(scores, key=lambda kind: scores[kind])
    if scores[best] > RIGHT:
        yield f"line {link}: its bytes are none of the protocol {kind}; {best} fits: use --protocol {best}"


def _score(kind: str, sample: Sequence[Chunk]) -> float:
    """Return how well a protocol fits: the share of texts of the device that answer the last request."""
    reader, fits, texts, last = protocols()[kind].reader(), 0, 0, ""
    for one in sample:
        text = reader.read(one.link if one.by_device else BRIDGE, Packet(one.link, 0, one.payload))
        for part in text.split(_BETWEEN):
            if UNKNOWN.match(part):
                texts += not part.startswith(PART)
            elif one.by_device:
                texts += 1
                fits += _fits(answer_of(part), last)
            else:
                last = part
    return fits / max(texts, 1)


def _fits(answer: Answer, last: str) -> bool:
    if answer.role is Role.RAW:
        return f", {ECHOED}: " in last
    if answer.role is not Role.ANSWER or answer.name.startswith(BY_CHANCE):
        return False
    return short(answer.name) in last if answer.name else bool(OBJECT_ANSWER.match(answer.value))
