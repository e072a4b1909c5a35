"""MAV_CMD_INJECT_FAILURE: refused unless allowed; its effect on messages and a sensor, never on a stop."""

import pytest

from firmware_bridge.drivers.driver import Reading
from firmware_bridge.intent import Disarm, EmergencyStop
from firmware_bridge.mavlink.frames import dialect
from firmware_bridge.mavlink.injection import LATER
from hil_tests.unit.teleop.bench import CYCLE, RarsBench, acks, rars
from hil_tests.unit.teleop.received import texts

INJECT = dialect.MAV_CMD_INJECT_FAILURE
LINK = dialect.FAILURE_UNIT_SYSTEM_MAVLINK_SIGNAL
BATTERY = dialect.FAILURE_UNIT_SYSTEM_BATTERY
OK, OFF, STUCK, DELAYED, HALVED = 0, 1, 2, 6, 7
ACCEPTED, DENIED = 0, 2


@pytest.fixture
def bench() -> RarsBench:
    made = rars()
    made.injects = True
    made.restart()
    made.stick(x=0)
    made.report()
    return made


def speed(bench: RarsBench) -> float:
    return bench.command.speed_mps


def inject(bench: RarsBench, unit: float, kind: float) -> int:
    """Send the command; return the result."""
    ((command, result),) = acks(bench.order(INJECT, unit, kind))
    assert command == INJECT
    return result


def test_without_the_option_it_is_refused_and_nothing_is_lost() -> None:
    bench = rars()
    replies = bench.order(INJECT, LINK, OFF)
    assert acks(replies) == [(INJECT, DENIED)]
    assert "--allow-fault-injection" in "".join(texts(replies))
    bench.stick(x=500)
    assert speed(bench) > 0


def test_all_messages_are_lost_until_the_failure_ends(bench: RarsBench) -> None:
    assert inject(bench, LINK, OFF) == ACCEPTED
    assert "injected failures: all messages are lost" in texts(bench.report())
    assert bench.stick(x=500) == []
    assert bench.order(400, 1) == []
    assert speed(bench) == 0
    assert inject(bench, LINK, OK) == ACCEPTED
    bench.stick(x=500)
    assert speed(bench) > 0


@pytest.mark.parametrize(
    ("command", "params", "stop"),
    [
        (dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, (0.0,), EmergencyStop()),
        (dialect.MAV_CMD_DO_FLIGHTTERMINATION, (1.0,), EmergencyStop(final=True)),
        (dialect.MAV_CMD_COMPONENT_ARM_DISARM, (0.0, 21196.0), Disarm(force=True)),
    ],
)
def test_a_stop_is_received_whatever_is_injected(
    bench: RarsBench, command: int, params: tuple[float, ...], stop: object
) -> None:
    for kind in (OFF, HALVED, DELAYED):
        assert inject(bench, LINK, kind) == ACCEPTED
    for number in range(4):
        assert acks(bench.order(command, *params)) == [(command, ACCEPTED)], number
    assert bench.requested[-1] == stop


def test_the_stop_button_is_received_too(bench: RarsBench) -> None:
    inject(bench, LINK, OFF)
    bench.stick(x=0, buttons=1 << 2)
    assert bench.requested == [EmergencyStop()]


def test_an_emergency_stop_ends_all_failures(bench: RarsBench) -> None:
    for unit, kind in ((LINK, OFF), (LINK, DELAYED), (BATTERY, OFF)):
        assert inject(bench, unit, kind) == ACCEPTED
    assert bench.operator.injection.active
    bench.order(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 0.0)
    bench.report()
    assert not bench.operator.injection.active


def test_every_second_message_is_lost(bench: RarsBench) -> None:
    inject(bench, LINK, HALVED)
    taken = []
    for x in range(100, 900, 100):
        before = speed(bench)
        bench.stick(x=x)
        taken.append(speed(bench) > before)
    assert taken in ([True, False] * 4, [False, True] * 4)


def test_a_motion_command_takes_effect_later_and_in_order(bench: RarsBench) -> None:
    inject(bench, LINK, DELAYED)
    bench.stick(x=500)
    assert speed(bench) == 0
    bench.report()
    bench.stick(x=1000)
    for _ in range(LATER // CYCLE - 2):
        bench.report()
        assert speed(bench) == 0
    bench.report()
    half = speed(bench)
    bench.report()
    assert 0 < half < speed(bench)


def test_what_is_held_is_forgotten_at_an_emergency_stop(bench: RarsBench) -> None:
    inject(bench, LINK, DELAYED)
    bench.stick(x=500)
    bench.order(dialect.MAV_CMD_DO_SET_SAFETY_SWITCH_STATE, 0.0)
    for _ in range(2 * LATER // CYCLE):
        bench.report()
    assert speed(bench) == 0


def test_the_battery_is_silent_and_no_other_sensor(bench: RarsBench) -> None:
    battery = bench.robot.battery
    assert battery is not None
    readings = {battery.sensor: Reading(24.0, 0, 0), "other": Reading(1.0, 0, 0)}
    assert bench.operator.injection.seen(readings) == readings
    inject(bench, BATTERY, OFF)
    assert bench.operator.injection.seen(readings).keys() == {"other"}
    inject(bench, BATTERY, OK)
    assert bench.operator.injection.seen(readings) == readings


@pytest.mark.parametrize(
    ("unit", "kind", "known"),
    [
        (dialect.FAILURE_UNIT_SENSOR_GPS, OFF, "units of this robot are"),
        (0.5, OFF, "units of this robot are"),
        (float("nan"), OFF, "units of this robot are"),
        (LINK, STUCK, "types are 0: none, 1: all messages are lost"),
        (LINK, float("nan"), "types are"),
        (BATTERY, DELAYED, "types are 0: none, 1: the battery's sensor is silent"),
    ],
)
def test_another_failure_is_refused_with_those_that_are_possible(
    bench: RarsBench, unit: float, kind: float, known: str
) -> None:
    replies = bench.order(INJECT, unit, kind)
    assert acks(replies) == [(INJECT, DENIED)]
    assert known in "".join(texts(replies))
    assert bench.operator.injection.active == ()


@pytest.mark.parametrize("kind", ["disarmed", "control handed over"])
def test_what_is_held_does_not_outlive_a_change_of_state(bench: RarsBench, kind: str) -> None:
    """A command of before must not move the robot when it is armed again, or of another station."""
    bench.order(400, 1)
    inject(bench, LINK, DELAYED)
    bench.stick(x=500)
    if kind == "disarmed":
        bench.order(400, 0)
        bench.order(400, 1)
    else:
        bench.order(32100, 0)
    for _ in range(2 * LATER // CYCLE):
        bench.report()
        assert speed(bench) == 0
