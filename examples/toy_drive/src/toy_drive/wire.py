"""The toy drive's protocol: lines of ASCII, one answer to each request.

    P1  P0      power on, power off
    V-1250      speed of the motor's shaft, mrad/s
    S           quick stop: three times the acceleration; no speed is taken before the next P1
    Q           state

The answer is the request itself, then state, position in counts and speed in mrad/s: `V-1250 1 -3310 -1248`.
The protocol is made up; a real family names here the manual and its page.
"""

import re
from typing import Final, NamedTuple

POWER_ON, POWER_OFF, STOP, QUESTION = b"P1", b"P0", b"S", b"Q"
OFF, ON, STOPPED = range(3)
STATES: Final = ("power off", "power on", "stopped by itself or by S")
ANSWER: Final = re.compile(rb"(\S+) ([012]) (-?\d{1,12}) (-?\d{1,9})")


class Answer(NamedTuple):
    """One answer."""

    request: bytes
    state: int
    counts: int
    speed: int
    """mrad/s."""


def speed(mrad_s: int) -> bytes:
    """Return the request for a speed."""
    return b"V%d" % mrad_s


def answer_of(line: bytes) -> Answer | None:
    """Parse an answer; None for anything else."""
    found = ANSWER.fullmatch(line)
    return None if found is None else Answer(found[1], int(found[2]), int(found[3]), int(found[4]))


def decoded(line: bytes) -> str:
    """Return an answer as text, for people."""
    answer = answer_of(line)
    if answer is None:
        return f"no answer that is known: {line!r}"
    return f"{answer.request.decode()}: {STATES[answer.state]}, {answer.counts}, {answer.speed} mrad/s"
