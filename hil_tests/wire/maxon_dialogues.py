"""The golden exchanges as dialogues with their senders, and the ways in which they are cut into pieces."""

from collections.abc import Callable

from firmware_bridge.families.epos2.maxon.frame import Generation
from hil_tests.rows import every
from hil_tests.wire.maxon_frames import EXCHANGES, Exchange

Cut = Callable[[bytes], list[bytes]]
CUTS: dict[str, Cut] = {
    "whole": lambda raw: [raw] if raw else [],
    "byte by byte": lambda raw: [raw[i : i + 1] for i in range(len(raw))],
}
fragmented = every("cut", CUTS.values(), ids=lambda cut: next(name for name, it in CUTS.items() if it is cut))


def golden(exchange: Exchange, generation: Generation) -> tuple[bytes, bytes]:
    pair = exchange.v1 if generation is Generation.V1 else exchange.v2
    assert pair is not None
    return bytes.fromhex(pair[0]), bytes.fromhex(pair[1])


def dialogue(exchange: Exchange, generation: Generation) -> list[tuple[str, bytes]]:
    """Write down the senders: H the host, D the device."""
    requested, answered = golden(exchange, generation)
    if generation is Generation.V2:
        return [("H", requested), ("D", answered)]
    stated = [("H", requested[:1]), ("D", b"O"), ("H", requested[1:]), ("D", b"O")]
    if answered:
        stated += [("D", answered[:1]), ("H", b"O"), ("D", answered[1:]), ("H", b"O")]
    return stated


CASES = [
    (exchange, generation)
    for exchange in EXCHANGES
    for generation, pair in ((Generation.V1, exchange.v1), (Generation.V2, exchange.v2))
    if pair is not None
]
every_exchange = every(("exchange", "generation"), CASES)
