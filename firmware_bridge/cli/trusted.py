"""Trust of `drive`: a key in a file, a list of addresses, and the reach of the link."""

import hashlib
import ipaddress
import os
import re
import stat
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.mavlink.trust import KEY_LENGTH, Network, Trust
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import PortError
from firmware_bridge.runtime.ports.udp import reaches_beyond

SHORTEST_PHRASE: Final = 12
_HEXADECIMAL: Final = re.compile(rb"[0-9A-Fa-f]{64}")
_OTHERS: Final = stat.S_IRWXG | stat.S_IRWXO


def trust_of(link: str, key: Path | None, allow: Sequence[str] | None, *, openly: bool) -> Trust:
    """Return the trust; an error, or an open link without its option, ends the program."""
    with one_message(PortError):
        # Loopback needs no key: only programs of this machine reach it.
        beyond = reaches_beyond(link)
    if beyond and key is None and not openly:
        raise refusal(
            f"--mavlink {link}: others than this machine can reach it and drive the robot; use --key FILE, "
            "so that only who has the key can, or --open"
        )
    if key is not None and openly:
        raise refusal("--key and --open: with a key no one drives without it; leave one out")
    return Trust(
        key=None if key is None else key_in(key),
        started_at=Clock().started_at,
        allowed=tuple(_network(text) for text in allow or ()),
    )


def key_in(file: Path) -> bytes:
    """Read a key: 64 hexadecimal digits, or a phrase whose SHA-256 it is, as ground stations make it."""
    try:
        text, others = file.read_bytes().strip(), file.stat().st_mode & _OTHERS
    except OSError as error:
        raise refusal(f"--key {file}: cannot be read: {error.strerror}") from None
    if others and os.name == "posix":
        raise refusal(f"--key {file}: others on this machine can read it or change it; chmod 600 {file}")
    # Ground stations make the key of a phrase by SHA-256, so the same phrase fits here.
    key = bytes.fromhex(text.decode()) if _HEXADECIMAL.fullmatch(text) else hashlib.sha256(text).digest()
    if len(text) < SHORTEST_PHRASE or b"\n" in text or key == bytes(KEY_LENGTH):
        raise refusal(
            f"--key {file}: must hold 64 hexadecimal digits, or a line of at least {SHORTEST_PHRASE} letters"
        )
    return key


def _network(text: str) -> Network:
    try:
        return ipaddress.ip_network(text)
    except ValueError:
        raise refusal(
            f"--allow {text}: give an address, 192.168.1.10, or a network, 192.168.1.0/24"
        ) from None
