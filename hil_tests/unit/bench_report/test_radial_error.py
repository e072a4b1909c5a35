import math

import pytest

from emulators.bench.columns import PLANAR, SAMPLE_EVERY, Samples
from emulators.bench.piloted import Pilot
from emulators.bench.radial_error import radial_error
from firmware_bridge.units import to_seconds

CIRCLE = Pilot(path="circle", size_m=5.0, offset_m=0.01)


def run(swing_m: float, speed_mps: float = 0.5, seconds: int = 40) -> Samples:
    """Return a run along the circle from the far origin of a plant, with a swing and a drift to one side."""
    samples = Samples(PLANAR)
    for row in range(seconds * 100):
        at = to_seconds(row * SAMPLE_EVERY)
        angle, radius = speed_mps * at / 5.0, 4.99 + (swing_m * math.sin(2.0 * at) if at > 5.0 else 0.0)
        x, y = 7.0 + radius * math.sin(angle), 3.0 + 4.99 - radius * math.cos(angle)
        samples.add(row * SAMPLE_EVERY, (x, y, angle, speed_mps, speed_mps / 5.0, 0.0, 0.0, 0.0))
    return samples


@pytest.mark.parametrize("swing", [0.0, 0.03, 0.5])
def test_it_is_half_of_peak_to_peak_of_the_radius(swing: float) -> None:
    assert radial_error(run(swing), CIRCLE.placed, 20.0) == pytest.approx(swing, abs=2e-3 * swing + 1e-4)


def test_what_comes_before_it_has_settled_does_not_count() -> None:
    assert radial_error(run(0.03, seconds=15), CIRCLE.placed, 1.0) == pytest.approx(0.03, abs=1e-3)
    assert radial_error(run(0.03, seconds=15), CIRCLE.placed, 14.9) is None


def test_who_has_not_driven_has_followed_no_path() -> None:
    assert radial_error(run(0.0, speed_mps=0.0), CIRCLE.placed, 1.0) is None
    assert radial_error(run(0.0, speed_mps=0.02), CIRCLE.placed, 1.0) is None
