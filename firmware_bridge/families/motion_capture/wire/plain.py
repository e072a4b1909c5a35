"""The frames that come 240 times a second, in one stroke: rigid bodies, their labeled markers, and no more.

Such a frame has one layout for each version and number of bodies and markers. It is read and written at once,
four times as fast as row by row; what is laid out otherwise is left to the rows, which say the same of all.
"""

from collections.abc import Iterable
from functools import lru_cache
from itertools import chain
from struct import Struct, error
from typing import Any, Final

from firmware_bridge.families.motion_capture.wire.layout import V3_0, V4_1, Version

MOST: Final = 32
"""So many bodies, and markers, at most."""
_BODY: Final = "i3f4ffh"
_MARKER: Final = "i3ffhf"
_BODY_SIZE: Final = Struct(f"<{_BODY}").size
BODY_VALUES: Final = 10
MARKER_VALUES: Final = 7


class Plain:
    """One layout; a frame's values are those of the rows, in their order, counts and sizes among them."""

    def __init__(self, version: Version, bodies: int, markers: int) -> None:
        sized = version >= V4_1
        empty = ("", 0)
        between = [empty] * (2 if sized else 1)
        # Marker sets, other markers, bodies, skeletons, assets (from 4.1), markers, force plates, devices.
        lists = [empty, empty, (_BODY, bodies), *between, (_MARKER, markers), empty, empty]
        code = "i"
        announced: list[tuple[int, ...]] = []
        for item, count in lists:
            code += ("iI" if sized else "i") + item * count
            announced.append((count, count * Struct(f"<{item}").size) if sized else (count,))
        self._layout: Final = Struct(f"<{code}IIdQQQ{'2I' if sized else ''}hI")
        self.size: Final = self._layout.size
        seen, labeled = lists.index((_BODY, bodies)) + 1, lists.index((_MARKER, markers)) + 1
        self._before: Final = tuple(chain(*announced[:seen]))
        self._between: Final = tuple(chain(*announced[seen:labeled]))
        self._behind: Final = tuple(chain(*announced[labeled:]))
        self.bodies: Final = slice(1 + len(self._before), 1 + len(self._before) + BODY_VALUES * bodies)
        first = self.bodies.stop + len(self._between)
        self.markers: Final = slice(first, first + MARKER_VALUES * markers)
        self.tail: Final = slice(self.markers.stop + len(self._behind), None)

    def unpack(self, payload: bytes) -> tuple[Any, ...] | None:
        """Return the values; None where the payload is laid out otherwise."""
        if len(payload) != self.size:
            return None
        values = self._layout.unpack(payload)
        # Same length is no proof: another frame may have the same number of bytes by other counts.
        as_announced = (
            values[1 : self.bodies.start] == self._before
            and values[self.bodies.stop : self.markers.start] == self._between
            and values[self.markers.stop : self.tail.start] == self._behind
        )
        return values if as_announced and values[-1] == 0 else None

    def pack(
        self, number: int, bodies: Iterable[float], markers: Iterable[float], tail: Iterable[float]
    ) -> bytes | None:
        """Return the payload; None where a value does not fit."""
        try:
            return self._layout.pack(
                number, *self._before, *bodies, *self._between, *markers, *self._behind, *tail
            )
        except (error, TypeError, OverflowError):
            return None


def shown(payload: bytes, version: Version) -> Plain | None:
    """Return the layout that a payload has if it is such a frame."""
    announced = 8 if version >= V4_1 else 4
    at = 4 + 2 * announced
    # At a fixed place only where the two lists before it are empty; `unpack` finds out whether they are.
    bodies = int.from_bytes(payload[at : at + 4], "little")
    if bodies > MOST:
        return None
    at += announced + _BODY_SIZE * bodies + announced * (2 if version >= V4_1 else 1)
    return plain(version, bodies, int.from_bytes(payload[at : at + 4], "little"))


@lru_cache(maxsize=256)
def plain(version: Version, bodies: int, markers: int) -> Plain | None:
    """Return the layout of such a frame; None for a version before 3.0, or more than is usual."""
    if version < V3_0 or bodies > MOST or markers > MOST:
        return None
    return Plain(version, bodies, markers)
