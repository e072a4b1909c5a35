"""Whatever bytes are on a line, in whatever protocol: an explanation, and no exception."""

import json
from typing import Final

import hypothesis.strategies as st
from hypothesis import given

from firmware_bridge.dissector.dissector import kinds
from firmware_bridge.explain import report
from firmware_bridge.explain.explainer import Setup
from firmware_bridge.explain.line_explainer import Lines, explain_lines
from firmware_bridge.explain.line_source import Chunk
from firmware_bridge.units import MILLISECOND

PIECES: Final = (
    b"e\r",
    b"m 30 30 30\r",
    b"1 2 3\r\n",
    b"OK\r\n",
    b"MWProtocol",
    b"G0",
    b"99",
    b"4\r\n",
    b"TMq1\n",
    b"q1\n\r\n",
    bytes.fromhex("5A 03 00 01 03 F9"),
    bytes.fromhex("A5 00 00 04 03 02 00 F7"),
    bytes.fromhex("90 02 10 02 41 60 00 01 8C A7"),
    bytes.fromhex("90 02 00 04 00 00 00 00 92 01 02 00 9A ED"),
    bytes.fromhex("F0 79 F7"),
)
CHUNKS: Final = st.lists(
    st.tuples(
        st.integers(0, 300 * MILLISECOND),
        st.booleans(),
        st.one_of(st.sampled_from(PIECES), st.binary(min_size=1, max_size=12)),
    ),
    max_size=60,
)
PROTOCOLS: Final = st.sampled_from(("", "unknown", *kinds()))


@given(CHUNKS, PROTOCOLS)
def test_any_chunks_are_explained(pieces: list[tuple[int, bool, bytes]], protocol: str) -> None:
    at, chunks = 0, []
    for later, by_device, payload in pieces:
        at += later
        chunks.append(Chunk(at, "line", by_device, payload, None))
    found = explain_lines(chunks, Lines({"line": protocol} if protocol else {}, Setup()))
    assert found.frames == len(pieces)
    assert list(report.text(found, "any"))
    assert json.dumps(report.data(found, "any"))
    assert all(one.recovered_at is None or one.recovered_at >= one.at for one in found.incidents)
