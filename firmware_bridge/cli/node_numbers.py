"""Several nodes in one option: `1`, `1-8` or `1,3,5-7`; and the other way round."""

import re
from collections.abc import Sequence

from firmware_bridge.canopen.cia301 import FIRST_NODE, LAST_NODE
from firmware_bridge.cli.console import refusal


def numbers(text: str) -> tuple[int, ...]:
    """Read `1`, `1-8` or `1,3,5-7`; what is no such list ends the program with a message."""
    found: list[int] = []
    for part in text.split(","):
        fits = re.fullmatch(r"(\d+)(?:-(\d+))?", part.strip())
        if fits is None:
            raise refusal(f"--node {text}: give 1, or 1-8, or 1,3,5-7")
        first, last = int(fits[1]), int(fits[2] or fits[1])
        if not FIRST_NODE <= first <= last <= LAST_NODE:
            raise refusal(f"--node {text}: nodes are numbered {FIRST_NODE} to {LAST_NODE}, upwards")
        found.extend(range(first, last + 1))
    # A node in two ranges would be searched twice.
    if len(set(found)) != len(found):
        raise refusal(f"--node {text}: a number occurs twice")
    return tuple(found)


def listed(nodes: Sequence[int]) -> str:
    """Write ascending numbers as `numbers` reads them: 1,3,5-7."""
    parts: list[tuple[int, int]] = []
    for node in nodes:
        if parts and parts[-1][1] == node - 1:
            parts[-1] = (parts[-1][0], node)
        else:
            parts.append((node, node))
    return ",".join(f"{first}" if first == last else f"{first}-{last}" for first, last in parts)
