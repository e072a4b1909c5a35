"""What a bus has carried lately, against counting all frames again at each instant."""

from collections import Counter

from hypothesis import example, given
from hypothesis import strategies as st

from firmware_bridge.dissector.traffic import BURST, RECENT, Traffic

STEPS = st.sampled_from((0, 1, BURST // 2, BURST - 1, BURST, RECENT // 2, RECENT - 1, RECENT, 3 * RECENT))
FRAMES = st.lists(st.tuples(STEPS, st.integers(0, 3), st.integers(1, 150)), min_size=1)


@given(FRAMES, STEPS)
@example([(0, 1, 100), (RECENT - 1, 1, 50)], 0)
@example([(0, 1, 100), (RECENT, 1, 50)], 0)
@example([(0, 1, 100), (0, 2, 50), (BURST, 1, 60)], RECENT)
def test_frames_are_forgotten_when_they_are_as_old_as_the_span(
    frames: list[tuple[int, int, int]], after: int
) -> None:
    traffic, came, now, peak = Traffic(), list[tuple[int, int, int]](), 0, 0
    for step, address, bits in frames:
        now += step
        traffic.add(now, address, bits)
        came.append((now, address, bits))
        peak = max(peak, sum(bits for at, _, bits in came if at > now - BURST))
        assert traffic.peak == peak
    for at in (now, now + after):
        recent = [(address, bits) for when, address, bits in came if when > at - RECENT]
        assert traffic.bits(at) == sum(bits for _, bits in recent)
        assert traffic.frames(at) == Counter(address for address, _ in recent)
