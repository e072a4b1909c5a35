"""Opening of the links of emulated drives: a bus, the serial line of one of them, or both."""

from firmware_bridge.cli.links import Openers, opened
from firmware_bridge.cli.outside import Outside
from firmware_bridge.families.epos2.maxon.frame import Generation


def drives_opened(
    outside: Outside, protocol: Generation | None, baud: int, default_bit_rate: int
) -> tuple[Openers, str]:
    """Return what opens each link, and how they are called; see `firmware_bridge.cli.links.opened`."""
    spoken = "v1 or v2, as its host speaks" if protocol is None else protocol.value
    # Over USB a rate is set, and does not count.
    return opened(outside, spoken, baud, default_bit_rate, any_rate=protocol is not Generation.V1)
