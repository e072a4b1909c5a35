"""A CAN frame's address word: identifier and flags as SocketCAN packs them."""

from typing import Final

EXTENDED: Final = 1 << 31
"""Flag: 29-bit identifier."""
REMOTE: Final = 1 << 30
"""Flag: remote transmission request; the payload's length is the length code, its bytes do not count."""
ERROR: Final = 1 << 29
"""Flag: an error report of the controller, not a frame of the bus."""
STANDARD_MASK: Final = 0x7FF
EXTENDED_MASK: Final = 0x1FFF_FFFF
MAX_PAYLOAD: Final = 8


def identifier(address: int) -> int:
    """Return the 11-bit or 29-bit identifier without its flags."""
    return address & (EXTENDED_MASK if address & EXTENDED else STANDARD_MASK)
