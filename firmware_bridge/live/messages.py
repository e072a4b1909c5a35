"""The live page's messages: names, limits and encoding, which a bench and a robot share."""

import json
from typing import Final

from firmware_bridge.live.state import Json
from firmware_bridge.units import MILLISECOND, Nanoseconds

VERSION: Final = 1
LIVE: Final = "live"
"""The link of the page's port; an address is a page."""
ALL_PAGES: Final = 0
OPENED: Final = b""
CLOSED: Final = b"\0"
"""What comes of a page that has opened its WebSocket, and of one that has left."""
SHOWN_EVERY: Final[Nanoseconds] = 50 * MILLISECOND
MOST_EVENTS: Final = 500
LEVELS: Final = ("error", "error", "error", "error", "warning", "info", "info", "info")
"""The page's levels by MAV_SEVERITY."""


def encoded(message: Json) -> bytes:
    """Return a message as JSON; ValueError for a number that JSON does not have."""
    return json.dumps(message, separators=(",", ":"), allow_nan=False).encode()
