"""Two links in one robot, with equal node numbers on both: neither may take the other's word for its own."""

from collections.abc import Callable
from typing import Any, Final

import pytest

from firmware_bridge.drivers.all_drivers import all_drivers_of
from firmware_bridge.drivers.driver import Level, Power, SetPoint, Speed, Stop
from firmware_bridge.drivers.life_cycle import Transition
from firmware_bridge.drivers.link_drivers import LinkDrivers
from firmware_bridge.families.ar2.settings import Ar2Driver
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.settings import Epos2Driver
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.motion_capture.settings import CaptureDriver
from firmware_bridge.families.motor_shield.settings import ShieldDriver
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Output
from firmware_bridge.robot.family_tables import words
from hil_tests.unit.drivers.link_drivers_bench import Bench
from hil_tests.unit.drivers.robots import LINK, changed

FRONT: Final = LINK
REAR: Final = "rear"


def four_wheels(table: dict[str, Any]) -> None:
    """Two wheels on each of two links, nodes 1 and 2 on both."""
    table["links"][REAR] = dict(table["links"][FRONT], bridge_node=101)
    wheels = table["axes"][:2]
    behind = [
        wheel | {"name": f"rear_{wheel['name']}", "role": f"rear_{wheel['role']}", "link": REAR}
        for wheel in wheels
    ]
    table["axes"] = [*wheels, *behind]
    del table["guard"]


def on_can() -> AnyRobot:
    return changed(four_wheels)


def on_lines() -> AnyRobot:
    return over_serial(changed(four_wheels))


def on_both() -> AnyRobot:
    def change(table: dict[str, Any]) -> None:
        four_wheels(table)
        table["links"][REAR] |= {"driver": "epos2-serial", "gateway": 2}

    return changed(change)


def recovers(link_drivers: LinkDrivers) -> list[Packet]:
    return [packet for driver in link_drivers.drivers for packet in driver.begin(Transition.RECOVER, 0)]


ROBOTS = pytest.mark.parametrize("make", [on_can, on_lines, on_both])


def test_every_driver_of_the_robot_file_makes_link_drivers() -> None:
    assert set(words("link")) >= {*Epos2Driver, *ShieldDriver, *Ar2Driver, *CaptureDriver}


@ROBOTS
def test_each_link_has_drivers_of_its_own_in_the_file_s_order(make: Callable[[], AnyRobot]) -> None:
    front, rear = all_drivers_of(make())
    assert [front.name, rear.name] == [FRONT, REAR]
    assert [driver.axis.name for driver in rear.drivers] == ["rear_left", "rear_right"]


@ROBOTS
def test_what_is_sent_has_the_link_s_name(make: Callable[[], AnyRobot]) -> None:
    for link_drivers in all_drivers_of(make()):
        set_points: dict[str, SetPoint] = {driver.axis.name: Speed(1.0) for driver in link_drivers.drivers}
        sent = (
            *recovers(link_drivers),
            *link_drivers.link.sample(0),
            *link_drivers.link.beat(0),
        )
        sent += (
            *link_drivers.command(dict.fromkeys(set_points, Stop.QUICK_STOP)),
            *link_drivers.command(set_points),
        )
        assert sent
        assert {packet.link for packet in sent} == {link_drivers.name}


def test_a_sample_on_one_link_is_none_on_the_other() -> None:
    front, rear = all_drivers_of(on_can())
    for link_drivers in (front, rear):
        recovers(link_drivers)
    before = [driver.feedback for driver in rear.drivers]
    front.link.receive(Packet(FRONT, 0x701, b"\x05"), 1)
    front.link.receive(Packet(FRONT, 0x081, bytes.fromhex("11 86 20 00 00 00 00 00")), 1)
    assert front.drivers[0].feedback.fault == "0x8611, following error larger than 0x6065"
    assert [driver.feedback for driver in rear.drivers] == before


@pytest.mark.long(keeps=["on_can"])
@ROBOTS
def test_both_links_come_up_and_each_drive_takes_its_own_set_point(make: Callable[[], AnyRobot]) -> None:
    bench = Bench(make())
    bench.starts()
    wanted = {"left": 2.0, "right": -2.0, "rear_left": 4.0, "rear_right": 0.0}
    bench.host.set_points = {name: Speed(speed) for name, speed in wanted.items()}
    bench.runs(1.0)
    for name, speed in wanted.items():
        feedback = bench.feedback(name)
        assert feedback.power is Power.ON
        assert feedback.velocity == pytest.approx(speed, abs=0.1)
        assert feedback.position * speed >= 0.0
    assert bench.guard.refusals == ()


@pytest.mark.long(keeps=["on_can"])
@ROBOTS
def test_a_link_that_is_cut_leaves_the_other_one_alone(make: Callable[[], AnyRobot]) -> None:
    """Without the guard: it stops all axes where one of them is not spoken to any more."""
    bench = Bench(make(), guarding=False)
    bench.starts()
    bench.host.repairs = False
    bench.host.set_points = dict.fromkeys(("left", "right", "rear_left", "rear_right"), Speed(2.0))
    bench.runs(0.5)
    cut_at = bench.world.now
    for name in ("rear_left", "rear_right"):
        bench.world.silence(name, cut_at)
    bench.runs(0.5)
    for name in ("left", "right"):
        assert bench.feedback(name).sampled_at > cut_at
        assert bench.feedback(name).velocity == pytest.approx(2.0, abs=0.1)
    for name in ("rear_left", "rear_right"):
        assert bench.feedback(name).sampled_at <= cut_at
        assert bench.drives[name].store.get(at.VELOCITY_AVERAGED) == 0, "the drive stopped by itself"


@pytest.mark.long(keeps=["0.1501-on_can"])
@ROBOTS
@pytest.mark.parametrize("after", [0.0, 0.1501, 0.7003, 2.0517])
def test_drivers_that_were_taken_back_go_on_as_they_went(make: Callable[[], AnyRobot], after: float) -> None:
    """With sensors and outputs, in the middle of the set-up and of requests."""
    robot = make()
    lamp = {"name": "lamp", "title": "lamp", "link": REAR, "settings": {"axis": "rear_left", "output": 2}}
    bench = Bench(robot.model_copy(update={"outputs": (Output.model_validate(lamp),)}))
    bench.host.levels = {"lamp": Level(on=True)}
    bench.runs(after)
    kept = bench.world.snapshot()
    ends = []
    for _ in range(2):
        bench.runs(0.4)
        ends.append((bench.world.trace_sha256, bench.feedback("rear_left"), bench.readings()))
        bench.world.restore(kept)
    assert ends[0] == ends[1]
