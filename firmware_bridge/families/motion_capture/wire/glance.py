"""A listener's view of a frame: its stamps, and a body by its number, decoded on request."""

from typing import Any, Final

from firmware_bridge.families.motion_capture.wire.frame import Frame, RigidBody, decoded
from firmware_bridge.families.motion_capture.wire.layout import Version
from firmware_bridge.families.motion_capture.wire.plain import BODY_VALUES, shown

_STAMPS: Final = slice(2, 6)
"""In the tail: timestamp, exposed, received, sent. Timecode and subframe stand before them."""


class Glance:
    """Of one frame; fields as in `Frame`."""

    def __init__(
        self,
        stamps: tuple[float, int, int],
        params: int,
        flat: tuple[Any, ...],
        bodies: tuple[RigidBody, ...],
    ) -> None:
        self.timestamp_s, self.exposed, self.sent = stamps
        self.params: Final = params
        self._flat: Final = flat
        """The values of bodies that were not requested."""
        self._bodies: Final = bodies

    def body(self, number: int) -> RigidBody | None:
        """Return the last body with this number; None where there is none."""
        # The last one counts, as for a client that fills a table by number.
        for body in reversed(self._bodies):
            if body.id == number:
                return body
        flat = self._flat
        for at in range(len(flat) - BODY_VALUES, -1, -BODY_VALUES):
            if flat[at] == number:
                return RigidBody(
                    number, flat[at + 1 : at + 4], flat[at + 4 : at + 8], flat[at + 8], flat[at + 9]
                )
        return None


def glance(payload: bytes, version: Version) -> Glance:
    """Look at a frame; NatNetError where `decoded` has one."""
    layout = shown(payload, version)
    values = None if layout is None else layout.unpack(payload)
    if layout is None or values is None:
        return _of_rows(decoded(payload, version))
    tail = values[layout.tail]
    timestamp, exposed, _, sent = tail[_STAMPS]
    # params is the last field but one; the end marker is the last.
    return Glance((timestamp, exposed, sent), tail[-2], values[layout.bodies], ())


def _of_rows(frame: Frame) -> Glance:
    return Glance((frame.timestamp_s, frame.exposed, frame.sent), frame.params, (), frame.bodies)
