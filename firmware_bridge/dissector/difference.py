"""The first difference between two runs of packets, decoded, with the packets before it."""

from collections.abc import Mapping, Sequence
from itertools import zip_longest
from types import MappingProxyType
from typing import Final

from firmware_bridge.dissector.dissector import Carried, Dissector

BEFORE: Final = 5
"""So many packets that came before are shown."""
NOTHING: Final = "nothing more"


def first_difference(
    expected: Sequence[Carried], actual: Sequence[Carried], kinds: Mapping[str, str] = MappingProxyType({})
) -> str | None:
    """Return some lines on the first packet that is not as expected; None where all are.

    `kinds` as for `Dissector`.
    """
    for place, (wanted, came) in enumerate(zip_longest(expected, actual)):
        if wanted != came:
            head = f"packet {place + 1} is the first that differs"
            return difference_text(head, expected[:place], wanted, came, kinds)
    return None


def difference_text(
    head: str,
    before: Sequence[Carried],
    wanted: Carried | None,
    came: Carried | None,
    kinds: Mapping[str, str] = MappingProxyType({}),
) -> str:
    """Return some lines on two packets that should be one: `head`, those that came before, and both."""
    dissector, other = Dissector(kinds), Dissector(kinds)
    context = [(dissector.read(one), other.read(one))[0] for one in before]
    pair = (_line(wanted, dissector), _line(came, other))
    lines = [
        head,
        *(f"          {line}" for line in context[-BEFORE:]),
        f"expected  {pair[0]}",
        f"but came  {pair[1]}",
    ]
    if wanted is not None and came is not None and pair[0] == pair[1]:
        lines += [f"bytes     {wanted.packet.payload.hex()}", f"but came  {came.packet.payload.hex()}"]
    return "\n".join(lines)


def _line(carried: Carried | None, dissector: Dissector) -> str:
    return NOTHING if carried is None else dissector.read(carried)
