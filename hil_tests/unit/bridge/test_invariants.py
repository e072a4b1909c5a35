"""What looks at every bridge at every instant finds a bridge that breaks a rule."""

from typing import TYPE_CHECKING, Any

import pytest

from firmware_bridge.bridge.joint_state import Event, Life, Motion
from firmware_bridge.drivers.life_cycle import Transition

if TYPE_CHECKING:
    from hil_tests.unit.bridge.bench import Bench

pytestmark = pytest.mark.interpreted


def inside(bench: "Bench") -> Any:
    return bench.bridge


def test_one_that_is_armed_without_a_request_is_found(started: "Bench") -> None:
    inside(started)._permission.motion = Motion.ARMED  # noqa: SLF001 - it breaks the rule
    with pytest.raises(AssertionError, match="armed without a request"):
        inside(started).wake(started.now)


def test_one_that_is_armed_at_its_end_is_found(armed: "Bench") -> None:
    inside(armed).phase = Life.STOPPING
    with pytest.raises(AssertionError, match="stopping and armed: only a bridge that runs"):
        armed.runs(0.1)


def test_power_that_is_given_in_an_emergency_stop_is_found(armed: "Bench") -> None:
    bridge = inside(armed)
    bridge._permission.happens(Event.STOP)  # noqa: SLF001 - as above
    driver = bridge._all_drivers.drivers[0]  # noqa: SLF001 - as above
    driver.begin(Transition.RECOVER, armed.now)
    with pytest.raises(AssertionError, match=r"stopped, and power is given to left"):
        bridge.wake(armed.now)


def test_a_command_beyond_what_is_allowed_is_found(armed: "Bench", monkeypatch: pytest.MonkeyPatch) -> None:
    from firmware_bridge.robots.rars.kinematics import Rars  # noqa: PLC0415 - one test's own

    armed.runs(0.5)
    monkeypatch.setattr(Rars, "ramped", lambda _self, _commanded, allowed, *_: type(allowed)(speed_mps=0.25))
    with pytest.raises(AssertionError, match=r"speed: 0.25 is commanded, 0 before, 0 allowed"):
        armed.runs(0.5)


def test_a_stop_that_sends_nothing_is_found(armed: "Bench", monkeypatch: pytest.MonkeyPatch) -> None:
    from hil_tests.unit.bridge.bench import driving  # noqa: PLC0415 - as above

    driving(armed)
    bridge = inside(armed)
    monkeypatch.setattr(type(bridge._all_drivers), "command", lambda *_: ())  # noqa: SLF001 - as above
    bridge._permission.happens(Event.STOP)  # noqa: SLF001 - as above
    with pytest.raises(AssertionError, match="an emergency stop, and nothing has left on"):
        armed.runs(0.5)
