"""Feedback of an axis whose device reports no power: its last command, while its set-up is in force."""

import pytest

from firmware_bridge.drivers.driver import Feedback, Power, Reports
from firmware_bridge.drivers.line_driver import LineDriver
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.units import MILLISECOND, NEVER
from hil_tests.unit.drivers.request_line_bench import AXIS, Line


class Driver(LineDriver):
    """An axis that was answered of at 7 ms, sampled at 5 ms."""

    def answered(self) -> "Driver":
        self._position, self._velocity = 0.25, -1.5
        self._received_at, self._sampled_at = 7 * MILLISECOND, 5 * MILLISECOND
        return self

    @property
    def feedback(self) -> Feedback:
        return self.as_commanded("driven", "released", reference_lost=False)


def driver(*, configured: bool, answered: bool, enabled: bool) -> Driver:
    line = Line().link
    line.configured = configured
    made = Driver(AXIS, line, frozenset({Reports.POSITION}))
    made.enabled = enabled
    return made.answered() if answered else made


@pytest.mark.parametrize("enabled", [False, True])
@pytest.mark.parametrize(("configured", "answered"), [(False, False), (False, True), (True, False)])
def test_power_is_unknown_without_a_set_up_or_a_first_answer(
    *, configured: bool, answered: bool, enabled: bool
) -> None:
    feedback = driver(configured=configured, answered=answered, enabled=enabled).feedback
    assert (feedback.power, feedback.text) == (Power.UNKNOWN, "")
    assert (feedback.received_at == NEVER_RECEIVED) is not answered


@pytest.mark.parametrize(
    ("enabled", "power", "text"), [(True, Power.ON, "driven"), (False, Power.OFF, "released")]
)
def test_power_is_that_of_the_last_command(*, enabled: bool, power: Power, text: str) -> None:
    assert driver(configured=True, answered=True, enabled=enabled).feedback == Feedback(
        axis=AXIS.name,
        power=power,
        received_at=7 * MILLISECOND,
        sampled_at=5 * MILLISECOND,
        position=0.25,
        velocity=-1.5,
        text=text,
        reference_lost=False,
    )


def test_a_lost_reference_is_reported_and_power_off_is_what_the_device_has_confirmed() -> None:
    one = driver(configured=True, answered=True, enabled=False)
    assert one.as_commanded("", "", reference_lost=True).reference_lost
    confirmed = [one.unpowered]
    one.released = True
    assert [*confirmed, one.unpowered] == [False, True]
    assert (one.wake_at, one.between) == (NEVER, None)
