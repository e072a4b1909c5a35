"""The picture before a station's operator: old as it comes, or moved to the newest pose."""

import json
from typing import Final

from firmware_bridge.node import Finite, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.pilot.driver import Sight
from firmware_bridge.pilot.station import PilotStation
from firmware_bridge.pilot.video import Video, VideoFeed
from firmware_bridge.units import MILLISECOND, Nanoseconds

VIEW: Final = "view"
"""The link of what draws it: lines of JSON with poses `picture` and `now`, [x, y, heading] in m and rad."""
PERIOD: Final[Nanoseconds] = 100 * MILLISECOND


class Viewing:
    """A `Node` around a station's; what is not the view's passes."""

    def __init__(self, node: Node, station: PilotStation, video: Video, *, predicted: bool) -> None:
        """Show the station's robot by pictures; `predicted`: as they look from the newest pose that came."""
        self._node: Final = node
        self._station: Final = station
        self._feed: Final = VideoFeed(video)
        self._predicted: Final = predicted
        self._filmed: Sight | None = None
        self._picture: Sight | None = None
        self._due: Nanoseconds = 0

    @property
    def holding(self) -> bool:
        """True while the node keeps a robot from moving after a command to end."""
        return holds(self._node)

    @property
    def finished(self) -> bool:
        """True once the node's own time is over."""
        return isinstance(self._node, Finite) and self._node.finished

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Pass it on; a pose that has come is filmed."""
        reaction = self._node.receive(packet, now)
        newest = self._station.shown.newest
        if newest is not None and newest is not self._filmed:
            self._filmed = newest
            self._feed.filmed(newest)
        return Reaction(reaction.sent, min(reaction.wake_at, self._due))

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node; send what is to be drawn ten times a second."""
        reaction = self._node.wake(now)
        self._picture = self._feed.shown(now) or self._picture
        sent: tuple[Packet, ...] = ()
        if now >= self._due:
            self._due = now + PERIOD
            sent = self._drawn()
        return Reaction((*reaction.sent, *sent), min(reaction.wake_at, self._due))

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the node, where it can be stopped."""
        return self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()

    def _drawn(self) -> tuple[Packet, ...]:
        picture, newest = self._picture, self._station.shown.newest
        if picture is None or newest is None:
            return ()
        shown = newest if self._predicted else picture
        line = json.dumps({"picture": _row(picture), "now": _row(shown)}) + "\n"
        return (Packet(VIEW, 0, line.encode()),)


def _row(sight: Sight) -> tuple[float, float, float]:
    pose = sight.moving.pose
    return pose.x_m, pose.y_m, pose.heading_rad
