"""Conditions of a link, each way, and their text, a row for each key: `delay=0.5,up.loss=0.02`."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Final

from firmware_bridge.robot.problems import near
from firmware_bridge.units import SECOND, Nanoseconds, from_seconds

UP: Final = "up"
"""From the operator to the robot."""
DOWN: Final = "down"
DIRECTIONS: Final = (UP, DOWN)


class ConditionsError(ValueError):
    """Texts for a link without conditions; one line."""


@dataclass(frozen=True, slots=True)
class LinkDirection:
    """One way of a link; the default carries everything at once."""

    delay: Nanoseconds = 0
    jitter: Nanoseconds = 0
    """Up to so much more, evenly spread: packets may overtake one another."""
    loss: float = 0.0
    """Share of the packets that never arrive."""
    burst: float = 0.0
    """Mean number of losses in a row (Gilbert's model); 0: each by itself."""
    duplicate: float = 0.0
    """Share of the packets that arrive twice, each with its own jitter."""
    bandwidth: float = 0.0
    """bit/s of a serial line, ten bits a byte: packets queue; 0: no bound."""
    queue: Nanoseconds = SECOND
    """Longest wait of a packet, which is lost beyond it. Assumed: a radio's buffer of a second."""


@dataclass(frozen=True, slots=True)
class Conditions:
    """Both ways."""

    up: LinkDirection = LinkDirection()
    down: LinkDirection = LinkDirection()


@dataclass(frozen=True, slots=True)
class ConditionKey:
    """One key: which field of a way it sets, and to what."""

    field: str
    meaning: str
    most: float
    into: Callable[[float], Any] = float
    halved: bool = False
    """Given for both ways together, each has half of it."""
    least: float = 0.0


ROWS: Final = {
    "delay": ConditionKey("delay", "s, there and back: half of it each way, or as up.delay and down.delay",
                          60.0, from_seconds, halved=True),
    "jitter": ConditionKey("jitter", "s, up to so much more each way", 60.0, from_seconds),
    "loss": ConditionKey("loss", "share that is lost each way", 1.0),
    "burst": ConditionKey("burst", "so many lost in a row on average", 1000.0, least=1.0),
    "duplicate": ConditionKey("duplicate", "share that comes twice", 1.0),
    "bandwidth": ConditionKey("bandwidth", "bit/s, as a serial line", 1e9, least=300.0),
    "queue": ConditionKey("queue", "s that a packet may wait for its turn", 60.0, from_seconds),
}  # fmt: skip


def conditions(text: str) -> Conditions:
    """Parse a link's conditions, `KEY=NUMBER` with commas between; one with `up.` or `down.` is for that way.

    ConditionsError gives the mistake, and the near name.
    """
    directions = {direction: LinkDirection() for direction in DIRECTIONS}
    seen: set[str] = set()
    for alone, part in sorted(_parts(text)):  # a value for one way wins over one for both
        key, sign, number = part.partition("=")
        direction, _, name = key.rpartition(".") if alone else ("", "", key)
        row = ROWS.get(name)
        if not sign or row is None or (alone and direction not in directions):
            raise ConditionsError(
                f"link: '{part}': {_expected(direction, name, alone=alone, sign=bool(sign))}"
            )
        if key in seen:
            raise ConditionsError(f"link: '{part}': {key} is given twice")
        seen.add(key)
        value = _number(part, number, row) / (2.0 if row.halved and not alone else 1.0)
        for one in (direction,) if alone else DIRECTIONS:
            directions[one] = replace(directions[one], **{row.field: row.into(value)})
    for name, read in directions.items():
        # At least one packet arrives between two bursts, which bounds the share of losses.
        most = read.burst / (read.burst + 1.0)
        if read.burst and read.loss > most:
            raise ConditionsError(f"link: bursts of {read.burst:g} {name} lose at most {most:.2f} of all")
    return Conditions(**directions)


def help_of_rows() -> str:
    """Return the keys in one line, for people."""
    return "; ".join(f"{key} ({row.meaning})" for key, row in ROWS.items())


def _parts(text: str) -> Iterator[tuple[bool, str]]:
    for part in text.split(","):
        yield "." in part.partition("=")[0], part.strip()


def _expected(direction: str, name: str, *, alone: bool, sign: bool) -> str:
    if alone and direction not in DIRECTIONS:
        return f"there is no direction '{direction}'; {near(direction, DIRECTIONS)}"
    if name in ROWS and not sign:
        return f"give {name}=NUMBER"
    return f"there is no key '{name}'; {near(name, list(ROWS))}"


def _number(part: str, text: str, row: ConditionKey) -> float:
    try:
        value = float(text)
    except ValueError:
        raise ConditionsError(f"link: '{part}': '{text}' is not a number") from None
    if not row.least <= value <= row.most:
        raise ConditionsError(f"link: '{part}': must be from {row.least:g} to {row.most:g}")
    return value
