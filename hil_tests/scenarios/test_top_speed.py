"""The base never passes its top speed by more than a hundredth, however it turns and reverses."""

from itertools import pairwise
from typing import Any, Final

import pytest

from hil_tests.scenarios.ride import ARMED, Ridden, step

TOP_MPS: Final = 0.505
"""A hundredth above the limit: what regulators may overshoot."""
LETS_THE_TURN_GO: Final = (
    (
        {"speed_mps": 0.5, "steer_deg": 40},
        {"speed_mps": -0.5, "steer_deg": 60},
        {"steer_deg": 40},
        {"steer_deg": -60},
        {"steer_deg": 0},
    ),
    ({"speed_mps": -0.5, "steer_deg": 60}, {"steer_deg": 60}, {"steer_deg": 0}, {"steer_deg": -60}),
)
"""Full speed into a tight turn, and out of it: it gives back to the wheels what it has taken."""


@pytest.mark.long(keeps=["1.0-steps0"])
@pytest.mark.parametrize("steps", LETS_THE_TURN_GO)
@pytest.mark.parametrize("mirrored", [1.0, -1.0])
def test_a_turn_that_straightens_does_not_drive_the_base_on(
    rides: Ridden, steps: tuple[dict[str, Any], ...], mirrored: float
) -> None:
    begins = [4.0 + 1.5 * number for number in range(len(steps) + 1)]
    done = [
        step(at, **{key: mirrored * value if key == "steer_deg" else value for key, value in does.items()})
        for (at, _), does in zip(pairwise(begins), steps, strict=True)
    ]
    ride = rides(ARMED, *done, seconds=20)
    ride.runs_until(begins[-1])
    assert 0.495 < ride.fastest() <= TOP_MPS
