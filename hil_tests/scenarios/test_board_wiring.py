"""A board without its shield, an I2C bus that is stuck, and wires that are exchanged: on every firmware."""

from typing import Final

import pytest

from emulators.rig import BRIDGE
from firmware_bridge.bridge.stops import Progress
from hil_tests.scenarios.rome_ride import FULL, STANDSTILL_MPS, driven, held, speed

CAUSES: Final = ("shield on it, powered", "I2C free", "AFMS.begin()")
SILENT: Final = ("ros-arduino-bridge", "arduinoio")
"""Firmwares that set the shield up in setup(): they hang there, and answer nothing at all."""


def fault(kind: str, at_s: float, keys: str = "") -> str:
    return f'[[fault]]\nkind = "{kind}"\nat_s = {at_s}\n{keys}\n'


@pytest.mark.parametrize("protocol", FULL)
@pytest.mark.parametrize("kind", ["shield_absent", "i2c_stuck"])
def test_a_board_without_its_shield_is_named_with_the_causes_and_not_armed(protocol: str, kind: str) -> None:
    """Within 3 s where it answers nothing; else soon behind its boot, where its set-up is not answered."""
    with driven(protocol, "speed_mps = 0.2", 12.0, fault(kind, 0.0), FULL[protocol]) as rig:
        boots_s = 3.3 if protocol == "firmata" else 1.2
        rig.runs(3.0 if protocol in SILENT else boots_s + 1.0)
        reported = " ".join(event.reason for event in rig.bridge.interlock_events)
        found = [reported.find(cause) for cause in CAUSES]
        assert found == sorted(found)
        assert found[0] > 0, reported
        if protocol in SILENT:
            places = [reported.find(cause) for cause in ("powered?", "port, at", "flashed with", *CAUSES)]
            assert places == sorted(places)
            assert places[0] > 0
        rig.runs(7.0)
        assert rig.bridge.failure is not None
        assert CAUSES[-1] in rig.bridge.failure
        assert not rig.bridge.seen.facts.armed
        assert speed(rig) < STANDSTILL_MPS


def test_a_board_that_answers_late_is_named_meanwhile_and_no_longer() -> None:
    """Firmata blinks its version for 3.3 s before it listens."""
    with driven("firmata", "speed_mps = 0.2", 12.0, encoders=2) as rig:
        rig.runs(3.0)
        (event,) = rig.bridge.interlock_events
        assert "it answers 3.3 s after a reset" in event.reason
        rig.runs(1.5)
        assert rig.bridge.failure is None
        assert "no answer" not in " ".join(event.reason for event in rig.bridge.interlock_events)


@pytest.mark.parametrize("protocol", FULL)
def test_a_bus_that_is_stuck_while_it_drives_takes_every_step_and_is_reported_at_the_end(
    protocol: str,
) -> None:
    with driven(protocol, "speed_mps = 0.2", 30.0, fault("i2c_stuck", 6.5), FULL[protocol]) as rig:
        rig.runs(15.0)
        assert speed(rig) > 0.1, "nothing is left that could stop it"
        assert {stop.progress for stop in rig.bridge.stops.values()} == {Progress.GIVEN_UP}
        assert {f"stop not acknowledged: {axis.name}" for axis in rig.robot.axes} <= held(rig)
        rig.world.stop(BRIDGE)
        rig.runs(10.0)
        assert rig.bridge.finished
        assert len(rig.bridge.not_acknowledged) == len(rig.robot.axes)


@pytest.mark.parametrize("kind", ["encoder_swapped", "motor_leads_swapped"])
def test_wires_that_were_exchanged_before_are_found_at_the_first_motion(kind: str) -> None:
    with driven("ros-arduino-bridge", "speed_mps = 0.2", 20.0, fault(kind, 0.0, 'node = "two"')) as rig:
        rig.runs(5.2)
        assert any(name.startswith(("uncommanded motion", "tracking error")) for name in held(rig))
        rig.runs(2.0)
        assert speed(rig) < STANDSTILL_MPS
        assert not rig.bridge.seen.facts.armed
