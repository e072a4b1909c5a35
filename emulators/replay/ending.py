"""End request of a recorded bridge: it is in no packet, and the bridge's later packets result from it."""

import re
from pathlib import Path
from typing import Final

from firmware_bridge.bridge import Life
from firmware_bridge.recording import EPOCH
from firmware_bridge.units import MICROSECOND, MILLISECOND, SECOND, Nanoseconds

_EVENT: Final = re.compile(r"\((\d+)\.(\d{6})\) +(\d+)\.(\d{3}) s  (.*)")
"""Line of events.log: time of writing, time of the event by the bridge's clock, and text."""
ENDING: Final = {Life.STOPPING.value, Life.LEAVING.value}
_ROUNDED: Final = 2 * MILLISECOND
"""Allowance for the bridge's times there: whole milliseconds, and logged a little later."""


def end_requested_at(events: Path) -> Nanoseconds | None:
    """Return an instant just before it, from the bench's epoch on; None where these events do not say it."""
    found = [it for it in map(_EVENT.match, events.read_text("utf-8", errors="replace").splitlines()) if it]
    rows = [(_instant(it, 1, MICROSECOND), _instant(it, 3, MILLISECOND), it[5]) for it in found]
    ended = next((since for _, since, text in rows if text in ENDING), None)
    if ended is None:
        return None
    # The clocks differ by a constant, and a late entry only adds to it: the smallest difference counts.
    return min(at - since for at, since, _ in rows) + ended - _ROUNDED - EPOCH


def _instant(event: re.Match[str], group: int, part: Nanoseconds) -> Nanoseconds:
    return int(event[group]) * SECOND + int(event[group + 1]) * part
