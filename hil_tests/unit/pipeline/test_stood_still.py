"""A bridge that was not let run: whatever happened meanwhile, no one has watched it."""

from typing import Final

import pytest

from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.unit.pipeline.cart import FakeCart

LIMIT: Final = 500 * MILLISECOND


@pytest.mark.parametrize(("gap", "armed"), [(LIMIT - 1, True), (LIMIT, False), (3 * SECOND, False)])
def test_it_moves_nothing_until_it_is_armed_again(gap: int, *, armed: bool) -> None:
    """All else is well: axes and operator are received as ever when it goes on."""
    cart = FakeCart()
    cart.arms()
    cart.ahead = 0.3
    cart.runs(20)
    assert cart.permission.armed
    cart.now += gap - cart.robot.cycle
    cart.runs(1)
    assert cart.permission.armed is armed
    cart.runs(20)
    assert cart.permission.armed is armed
    assert (cart.pipeline.seen.commanded.ahead == 0.0) is not armed
    cart.ahead = 0.0
    cart.runs(20)
    cart.arms()
    cart.ahead = 0.3
    cart.runs(20)
    assert cart.pipeline.seen.commanded.ahead == pytest.approx(0.3)
