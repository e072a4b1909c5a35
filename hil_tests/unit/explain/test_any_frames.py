"""Whatever is on a bus, in whatever order: an explanation, and no exception."""

import json
from typing import Final

import hypothesis.strategies as st
from hypothesis import given

from firmware_bridge.explain import report
from firmware_bridge.explain.explainer import Setup, explain
from firmware_bridge.explain.source import Frame
from firmware_bridge.units import MILLISECOND

SERVICES: Final = (0x000, 0x080, 0x081, 0x181, 0x201, 0x281, 0x401, 0x501, 0x581, 0x601, 0x701, 0x764, 0x7E5)
ADDRESSES: Final = st.one_of(
    st.sampled_from(SERVICES),
    st.integers(0, 0x7FF),
    st.integers(0, 0x1FFF_FFFF).map(lambda number: number | 1 << 31),
    st.integers(0, 0x1FF).map(lambda number: number | 1 << 29),
    st.sampled_from((0x701, 0x181)).map(lambda number: number | 1 << 30),
)
SDO: Final = st.builds(
    lambda command, index, rest: bytes((command,)) + index.to_bytes(2, "little") + rest,
    st.sampled_from((0x40, 0x23, 0x2B, 0x2F, 0x60, 0x43, 0x4B, 0x80, 0x22)),
    st.sampled_from(
        (0x6040, 0x6041, 0x6060, 0x6064, 0x607A, 0x1016, 0x1017, 0x1018, 0x1400, 0x1600, 0x1A00, 0x1010)
    ),
    st.binary(min_size=5, max_size=5),
)
FRAMES: Final = st.lists(
    st.tuples(
        st.integers(0, 400 * MILLISECOND),
        st.sampled_from(("can0", "can1")),
        ADDRESSES,
        st.one_of(st.binary(max_size=8), SDO),
    ),
    max_size=60,
)


@given(FRAMES, st.sampled_from(("", "epos2")))
def test_any_frames_are_explained(steps: list[Frame], device: str) -> None:
    at, frames = 0, []
    for step, bus, address, payload in steps:
        at += step
        frames.append((at, bus, address, payload))
    found = explain(frames, Setup(device=device))
    assert found.frames == len(frames)
    assert list(found.incidents) == sorted(found.incidents, key=lambda one: one.at)
    for incident in found.incidents:
        assert incident.what
        assert incident.causes
        assert incident.consequence
        assert incident.check
    json.dumps(report.data(found, "any"))
    lines = list(report.text(found, "any"))
    assert lines[-1].startswith("any: ")
    assert all("\n" not in line for line in (*lines, *report.markdown(found, "any")))
