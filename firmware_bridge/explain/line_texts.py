"""What the text of a decoded command means: rows of patterns on what a protocol's reader writes.

The readers are the families'; a row holds for each protocol whose texts have this form.
"""

import re
from dataclasses import dataclass
from enum import Enum
from typing import Final

from firmware_bridge.units import Nanoseconds


class Role(Enum):
    """What a text of the device is."""

    ANSWER = "answer"
    OTHER = "answer to an older request"
    BEGUN = "start"
    GARBAGE = "garbage"
    REFUSAL = "refusal"
    CHATTER = "chatter"
    NOTHING = "part"
    RAW = "raw bytes"


@dataclass(frozen=True, slots=True)
class Decoded:
    """One decoded text of one end."""

    at: Nanoseconds
    text: str
    payload: bytes
    """All bytes since the text before."""
    alone: bool = True
    """False where these bytes have several texts."""


@dataclass(frozen=True, slots=True)
class Answer:
    """What the device has sent."""

    role: Role
    name: str
    """Of the request that it answers; empty where the protocol does not show it."""
    value: str


_ROWS: Final = (
    (Role.NOTHING, r"part of a |okay$"),
    (Role.BEGUN, r"the board has begun|(?P<name>protocol version): (?P<value>.*)"),
    (Role.GARBAGE, r"a frame whose check sum is wrong|no command that is known"),
    (Role.REFUSAL, r"failed$|answer(?: to (?P<name>[^:]*))?: (?P<value>Invalid Command)$"),
    (Role.CHATTER, r"trace: |text: "),
    (Role.GARBAGE, r"answer(?: to [^:]*)?: (?:'|\"|.*(?:�|\\x))"),
    (Role.OTHER, r"answer to command 0x"),
    (Role.ANSWER, r"answer(?: to (?P<name>[^:]*))?(?:: (?P<value>.*))?$"),
    (Role.RAW, r"sent (?P<value>.*)$"),
    (Role.ANSWER, r"(?P<name>[^:,]*)[^:]*: (?P<value>.*)$"),
)
_ANSWERS: Final = tuple((role, re.compile(pattern, re.DOTALL)) for role, pattern in _ROWS)
_REQUEST: Final = re.compile(
    r"(?:#\d+ |[0-9A-Z]{1,2}, (?=[a-z]))?(?P<name>[^:]*)(?:: (?P<value>.*))?$", re.DOTALL
)
PART: Final = "part of a "
"""Begin of the text of bytes that complete nothing."""
OBJECT_ANSWER: Final = re.compile(r"error (?P<error>\d+)(?:, .*?raw (?P<raw>[0-9A-F ]+))?")
"""The answer to a command that reads or writes an object."""
BY_CHANCE: Final = ("analog I/O", "digital port")
"""Begins of what any three bytes may be, which shows no protocol."""
PRINTED: Final = re.compile(rb"[\t\r\n -~]*[A-Za-z][\t\r\n -~]*")
"""Bytes that are all text, with a letter."""
TEXT: Final = re.compile(rb"[A-Za-z][ -~]{2,}\r?\n")
"""A line of text."""
UNKNOWN: Final = re.compile(r"no (?:command|packet|message) |command 0x|on a link of unknown kind|part of a ")
UNACKNOWLEDGED: Final = re.compile(
    r"SendNMTService: .*command (?:129|130)$|encoder, (?!report)|encoder, report all by itself"
)
"""What is obeyed and not answered, though its name is that of what is."""
ECHOED: Final = "echo"
"""Name of the request whose answer is its own text."""


def answer_of(text: str) -> Answer:
    """Return what a text of the device is."""
    for role, pattern in _ANSWERS:
        found = pattern.match(text)
        if found is not None:
            groups = found.groupdict()
            return Answer(role, short(groups.get("name") or ""), groups.get("value") or "")
    return Answer(Role.ANSWER, text, "")


def request_of(text: str) -> tuple[str, str]:
    """Return the name of a request, and its values."""
    found = _REQUEST.match(text)
    return (text, "") if found is None else (short(found["name"]), found["value"] or "")


def short(name: str) -> str:
    """Return the name of a request as answers have it: without what stands behind a comma."""
    return name.partition(",")[0]


def shape_of(value: str) -> str:
    """Return the form of an answer: its text, each number as one digit."""
    return re.sub(r"-?\d+", "0", value)


# Motors and encoders

COMMANDS: Final = tuple(
    re.compile(pattern)
    for pattern in (
        r"motor speeds, in ticks a frame: (?P<each>-?\d+(?: -?\d+)*)$",
        r"raw PWM, -255 to 255: (?P<each>-?\d+(?: -?\d+)*)$",
        r"A, motor's speed: motor (?P<motor>\d+), value (?P<size>\d+)$",
        r"B, motor: f, b or r: motor (?P<motor>\d+), value (?P<way>[fbr])$",
        r"#\d+ (?:setSpeed|start)DCMotor: .*motor (?P<zero>\d+), speed (?P<size>\d+), direction (?P<way>\d)$",
        r"#\d+ (?P<stop>stop)DCMotor: .*motor (?P<zero>\d+)$",
        r"I2C request: .*, (?P<pin>\S+) of M(?P<motor>\d+) = (?P<level>\d+)$",
    )
)
"""Requests that command motors: sizes of all, or size, direction and number of one."""
WAYS: Final = {"f": 1, "b": -1, "r": 0, "1": 1, "2": -1, "4": 0, "0": 0}
"""Directions by their letters and digits."""
COUNTS: Final = tuple(
    re.compile(pattern)
    for pattern in (
        r"(?P<each>-?\d+(?: -?\d+)*)$",
        r"count (?P<count>-?\d+)(?:,|$)",
    )
)
"""Answers that have counts: those of all encoders, or of the one that was requested."""
NUMBERED: Final = re.compile(r"count (-?\d+) of encoder (\d+)")
READS: Final = re.compile(r"read encoders|readCount|read an encoder")
"""Names of the requests whose answers are counts."""
OF_ENCODER: Final = re.compile(r"encoder (\d+)")
ZEROED: Final = re.compile(
    r"reset encoders|#\d+ (?:writeCount|attachEncoder)|.*set an encoder to 0|.*attach an encoder|"
    r"encoder, count from 0|#\d+ readCount: .*reset 1"
)
"""Requests after which counts begin at another number."""
