"""Requests and answers of one line: what was not answered, late, damaged, or without a request."""

from collections import Counter, deque
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from firmware_bridge.explain import line_kinds as kinds
from firmware_bridge.explain.incident import Evidence, Incident, IncidentKind, Incidents, Report
from firmware_bridge.explain.line_texts import (
    ECHOED,
    OBJECT_ANSWER,
    PRINTED,
    TEXT,
    UNACKNOWLEDGED,
    Answer,
    Decoded,
    Role,
    request_of,
    shape_of,
)
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds, to_seconds

ANSWERED_WITHIN: Final[Nanoseconds] = 250 * MILLISECOND
"""Assumed: time for an answer, as drivers of such lines wait 50 to 200 ms."""
LATE: Final[Nanoseconds] = 55 * MILLISECOND
"""An answer after this time is late, where most come within half of it."""
SILENCE: Final[Nanoseconds] = 400 * MILLISECOND
"""A device that has sent nothing for this time, and left requests unanswered, is silent."""
GAP: Final[Nanoseconds] = 600 * MILLISECOND
"""Requests that stop for this time have stopped."""
TWO: Final = 2
"""Requests without an answer, before the device is silent."""
USUAL: Final = 8
"""Number of answers after which their form is known."""
UPSET: Final = SECOND
"""For this time after a silence or a start, requests and answers do not follow each other."""
SETTLED: Final = 5 * SECOND
"""An incident that was not seen for this time is over."""
_SHOWN: Final = 24
"""Bytes of an evidence."""


@dataclass(frozen=True, slots=True)
class Request:
    """One request that waits for its answer."""

    name: str
    sent: Decoded

    def repeats(self, other: "Request") -> bool:
        """Return whether it is the same again; a number in the sequence does not count."""
        return request_of(self.sent.text) == request_of(other.sent.text)


def evidence(decoded: Decoded) -> Evidence:
    """Return what shows an incident: the bytes, and their text."""
    shown = decoded.payload[:_SHOWN].hex(" ").upper() + (" ..." if len(decoded.payload) > _SHOWN else "")
    return Evidence(decoded.at, shown, decoded.text)


class Exchange:
    """The requests and answers of one line."""

    def __init__(self, incidents: Incidents) -> None:
        self._incidents = incidents
        self._waiting: deque[Request] = deque()
        self._answered: set[str] = set()
        self._lost: list[Request] = []
        self._shapes: dict[str, Counter[str]] = {}
        self._lengths: dict[str, Counter[int]] = {}
        self._times: deque[Nanoseconds] = deque(maxlen=64)
        self._requested_at: Nanoseconds | None = None
        self._cycle: Nanoseconds = 0
        self._sent_at: Nanoseconds | None = None
        self._upset_until: Nanoseconds = 0
        self._silence: Incident | None = None
        self._banner = False
        self.answers = 0
        self.requests = 0

    # Requests

    def requested(self, decoded: Decoded) -> tuple[str, str]:
        """Take a request of the controller; return its name and values."""
        at = decoded.at
        self._overdue(at)
        if self._requested_at is not None:
            gap = at - self._requested_at
            silent_until = 0 if self._silence is None else self._silence.recovered_at or 0
            waits = self._lost or self._incidents.is_open(kinds.NO_ANSWERS) or silent_until > at - gap
            if gap > max(GAP, 8 * self._cycle) and self.answers and not waits:
                self._stopped(self._requested_at, at)
            elif gap < SECOND:
                self._cycle = max(gap, self._cycle - self._cycle // 50)
        self._requested_at = at
        self.requests += 1
        name, value = request_of(decoded.text)
        if UNACKNOWLEDGED.match(decoded.text) is None:
            self._waiting.append(Request(name, decoded))
        return name, value

    def _stopped(self, began: Nanoseconds, ended: Nanoseconds) -> None:
        report = Report(what=f"no request for {to_seconds(ended - began):.1f} s")
        self._incidents.open(kinds.HOST_SILENT, began, report)
        self._incidents.close((kinds.HOST_SILENT,), ended, None, "requests come again")
        self._upset_until = ended + UPSET

    def _overdue(self, now: Nanoseconds) -> None:
        """Give up requests that were not answered in time."""
        while self._waiting and now - self._waiting[0].sent.at > ANSWERED_WITHIN:
            request = self._waiting.popleft()
            if request.name in self._answered:
                self._lost.append(request)
        self._silent(now)

    def _silent(self, now: Nanoseconds) -> None:
        since = self._sent_at
        if since is None or len(self._lost) < TWO or now - max(since, self._lost[0].sent.at) < SILENCE:
            return
        if self._lost[0].sent.at >= since or self._lost[-1].sent.at - since > SILENCE:
            first = self._lost[0]
            report = Report(what=f"no answer to {first.name}", evidence=evidence(first.sent))
            one = self._incidents.open(kinds.NO_ANSWERS, first.sent.at, report)
            one.count = 1
            one.what = f"no answer to {first.name}, and nothing else for {to_seconds(now - since):.1f} s"
            one.last_at = now

    # Answers

    def taken(self, decoded: Decoded) -> None:
        """Take bytes of the device, whatever they are."""
        self._overdue(decoded.at)
        silence = self._incidents.recent(kinds.NO_ANSWERS, decoded.at)
        if silence is not None and self._incidents.is_open(kinds.NO_ANSWERS):
            # A protocol without a banner does not show whether it has started again.
            silence.causes = kinds.CAME_BACK if self._banner else silence.causes
            self._incidents.close((kinds.NO_ANSWERS,), decoded.at, None, "it answers again")
            self._silence = silence
            self._upset_until = decoded.at + UPSET
        for request in self._lost if decoded.at > self._upset_until else ():
            report = Report(
                what=f"no answer to {request.name}",
                evidence=evidence(request.sent),
                detail=request.name,
            )
            self._incidents.open(kinds.LOST_ANSWER, request.sent.at, report)
        self._lost.clear()
        self._sent_at = decoded.at
        for kind in (kinds.LOST_ANSWER, kinds.LATE_ANSWER, kinds.GARBAGE, kinds.CHATTER, kinds.REFUSED):
            self._incidents.quiet_since(kind, decoded.at - SETTLED, "not seen again")

    def answered(self, decoded: Decoded, answer: Answer) -> Request | None:
        """Take an answer; return the request that it answers, where it is a good one."""
        request = self._request_of(answer, decoded.at)
        if request is None:
            self._without_request(decoded, answer)
            return None
        self._answered.add(request.name)
        self.answers += 1
        if answer.role is Role.OTHER:
            return None
        if self._misshapen(request, answer.value):
            self.garbage(decoded, f"the answer to {request.name} has another form than before")
            return None
        surplus = self._surplus(request, decoded, answer.value)
        if surplus:
            what = f"{surplus} bytes more than the answer to {request.name} has"
            self.garbage(decoded, what, beside=True)
        self._incidents.close((kinds.REBOOT,), decoded.at, None, "it answers again")
        self._timed(decoded, request)
        return request

    def _misshapen(self, request: Request, value: str) -> bool:
        """Return whether an answer has another form than those before, or is no echo of its request."""
        if request.name == ECHOED:
            # Texts without an end may stand before it.
            return not value.endswith(request_of(request.sent.text)[1])
        if OBJECT_ANSWER.match(value):
            return False
        shapes = self._shapes.setdefault(request.name, Counter())
        shape = shape_of(value)
        usual = shapes.most_common(1)
        known = shapes[shape] > 0 or not usual or usual[0][1] < USUAL
        # Counted all the same: a device that was changed answers otherwise for good.
        shapes[shape] += 1
        return not known

    def _surplus(self, request: Request, decoded: Decoded, value: str) -> int:
        """Return how many bytes came with an answer that always has the same length."""
        # The length of a text, and of a frame with doubled bytes, changes with its content.
        text = request.name == ECHOED or OBJECT_ANSWER.match(value) is not None
        if text or not decoded.alone or (value and value.encode("latin-1", "replace") in decoded.payload):
            return 0
        lengths = self._lengths.setdefault(request.name, Counter())
        length = len(decoded.payload)
        usual = lengths.most_common(1)
        lengths[length] += 1
        if not usual or usual[0][1] < USUAL or length <= usual[0][0]:
            return 0
        return length - usual[0][0]

    def _request_of(self, answer: Answer, at: Nanoseconds) -> Request | None:
        """Return the request that an answer is for, and give up those before it."""
        fitting = [one for one in self._waiting if answer.name in {"", one.name}]
        if not fitting:
            return None
        # An answer that comes too soon is an older request's.
        soon = self._usual() // 2
        while len(fitting) > 1 and self._given_up(fitting, at, soon):
            del fitting[0]
        request = fitting[0]
        while self._waiting:
            passed = self._waiting.popleft()
            if passed is request:
                break
            if passed.name in self._answered:
                self._lost.append(passed)
        return request

    @staticmethod
    def _given_up(fitting: Sequence[Request], at: Nanoseconds, soon: Nanoseconds) -> bool:
        """Return whether the oldest request was sent again, or is too old for several on their way."""
        oldest, *newer = fitting
        again = [one for one in newer if at - one.sent.at >= soon]
        late = at - oldest.sent.at > LATE
        return bool(again) and (late or any(one.repeats(oldest) for one in again))

    def _usual(self) -> Nanoseconds:
        """Return the usual time for an answer."""
        return sorted(self._times)[len(self._times) // 2] if self._times else 0

    def _timed(self, decoded: Decoded, request: Request) -> None:
        took = decoded.at - request.sent.at
        usual = self._usual()
        self._times.append(took)
        # The first answers may come from a device that is still starting.
        if (
            decoded.at <= self._upset_until
            or took <= LATE
            or len(self._times) < USUAL
            or 2 * usual > LATE
            or took < 4 * usual
        ):
            return
        report = Report(
            what=f"the answer to {request.name} came after {took // MILLISECOND} ms, usually "
            f"{usual / MILLISECOND:.0f} ms",
            evidence=evidence(decoded),
            detail=request.name,
        )
        self._incidents.open(kinds.LATE_ANSWER, request.sent.at, report)

    def _without_request(self, decoded: Decoded, answer: Answer) -> None:
        if not self.answers or decoded.at <= self._upset_until:
            return
        self.report(kinds.CHATTER, decoded, f"it sent an answer that was not requested: {answer.value}")

    def garbage(self, decoded: Decoded, what: str = "", *, beside: bool = False) -> None:
        """Take bytes that are no answer: a text, or what a disturbance leaves; `beside` a good answer."""
        if not self.answers or decoded.at <= self._upset_until:
            return
        if PRINTED.fullmatch(decoded.payload) or (beside and TEXT.search(decoded.payload)):
            self.report(kinds.CHATTER, decoded, "it prints a text that answers no request")
        else:
            self.report(kinds.GARBAGE, decoded, what or "bytes that are no answer")

    def report(self, kind: IncidentKind, decoded: Decoded, what: str) -> Incident:
        """Add an incident of the whole line."""
        return self._incidents.open(kind, decoded.at, Report(what=what, evidence=evidence(decoded)))

    def begun(self, decoded: Decoded, what: str) -> None:
        """Take the banner of a device that begins."""
        self._banner = True
        # The first one is no restart.
        if self.answers:
            self.report(kinds.REBOOT, decoded, what)
            self._upset_until = decoded.at + UPSET
            if self._silence is not None and decoded.at - (self._silence.recovered_at or 0) < UPSET:
                self._silence.causes = kinds.STARTED_AGAIN
        self._waiting.clear()

    def end(self, now: Nanoseconds) -> None:
        """Judge what the recording ends with."""
        self._overdue(now)
        requested = self._requested_at
        if requested is not None and self.answers and now - requested > max(GAP, 8 * self._cycle):
            self._incidents.open(
                kinds.HOST_SILENT,
                requested,
                Report(
                    what=f"no request from {to_seconds(now - requested):.1f} s "
                    "before the end of the recording"
                ),
            )
