"""Begin of a low battery: the first of the newest low samples, and no earlier one."""

import pytest

from firmware_bridge import robot_types
from firmware_bridge.drivers.driver import Reading
from firmware_bridge.safety.charge import Charge
from firmware_bridge.units import SECOND


def low_since(*volts: float) -> int | None:
    """Return its result after one sample a second, the first at second 1."""
    robot = robot_types.find("rars")
    assert robot.battery is not None
    charge, since = Charge(robot), None
    assert charge.low_since({}) is None
    for second, value in enumerate(volts, start=1):
        since = charge.low_since({robot.battery.sensor: Reading(value, second * SECOND, second * SECOND)})
    return since


@pytest.mark.parametrize(
    ("volts", "since"),
    [
        ((24.0,), None),
        ((21.0,), None),
        ((20.999,), 1),
        ((24.0, 20.0, 19.0, 18.0), 2),
        ((20.0, 24.0), None),
        ((20.0, 24.0, 20.0), 3),
    ],
)
def test_it_is_low_since_the_first_of_the_newest_low_samples(
    volts: tuple[float, ...], since: int | None
) -> None:
    assert low_since(*volts) == (None if since is None else since * SECOND)


def test_a_robot_without_a_battery_is_never_low() -> None:
    robot = robot_types.find("rars").model_copy(update={"battery": None})
    assert Charge(robot).low_since({"battery": Reading(1.0, SECOND, SECOND)}) is None
