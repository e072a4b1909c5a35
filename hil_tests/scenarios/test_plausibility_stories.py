"""Stories of axes that do not follow their commands, on the whole bench: detection, and its time."""

from collections.abc import Mapping
from typing import Final

import pytest

from emulators.bench.faults.site import ForeignNode
from emulators.testing.inherited.scripted import mission_of, scripted
from firmware_bridge.canopen_drive.driver.process_data import SET_POINT, SET_POINT_COB_ID
from firmware_bridge.drivers.driver import Feedback, Position, Power
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.intent import NEVER_RECEIVED
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, CommandForm
from firmware_bridge.robot_types import find
from firmware_bridge.safety.snapshot import Tracking
from firmware_bridge.safety.tracking import Followers, bounds_of
from firmware_bridge.units import MILLISECOND, from_seconds, to_seconds
from hil_tests.scenarios.ride import ARMED, Ridden, Ride, fault, step

RARS: Final[AnyRobot] = find("rars")
WATCHED: Final = ("tracking error", "uncommanded motion", "position not changing")
NOTICED_S: Final = 0.5
"""Within this time of the fault, or of the demand that it does not obey, the robot is disarmed."""
LINKS: Final = pytest.mark.parametrize("robot", [None, over_serial(RARS)], ids=["can", "serial"])
STANDS_BY_S: Final = {"can": 9.0, "serial": 10.0}
"""Time when all stages of a stop that nothing obeys are over: a serial line watches its drives later."""


def noticed(ride: Ride, name: str, after: float) -> float:
    """Return how long after an instant a hold of this name began; the robot is disarmed by then."""
    began = min(event.began for event in ride.rig.interlock_events if event.name.startswith(name))
    assert began >= from_seconds(after)
    assert not next(row for row in ride.rig.samples if row.at >= began + 60 * MILLISECOND)["armed"]
    return to_seconds(began) - after


@pytest.mark.long(keeps=["can"])
@LINKS
def test_a_drive_that_ignores_its_set_points_moves_uncommanded(
    rides: Ridden, robot: AnyRobot | None, request: pytest.FixtureRequest
) -> None:
    """It reports that it is enabled; demanded 0, measured 0.15 m/s."""
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.15),
        step(6.5, speed_mps=0.0),
        step(9.0, arm=True),
        seconds=20,
        robot=robot,
        faults=[fault("set_points_ignored", 6.0, node="left")],
    )
    stands_by = STANDS_BY_S[request.node.callspec.id]
    ride.runs_until(stands_by + 1.0)
    assert noticed(ride, "uncommanded motion: left", 6.5) < NOTICED_S
    assert "uncommanded motion: left" in ride.held_between(6.5, 7.0)
    assert not ride.now["armed"]
    assert ride.fastest(stands_by, stands_by + 1.0) < 0.005, (
        "it obeyed no word, and stopped when the heartbeat was withheld"
    )


def test_a_drive_that_ignores_a_speed_does_not_follow(rides: Ridden) -> None:
    """It holds its wheel at 0, and the robot, which the other wheel drives, drags that a little."""
    ride = rides(
        ARMED, step(4.5, speed_mps=0.3), seconds=20, faults=[fault("set_points_ignored", 4.2, node="left")]
    )
    ride.runs_until(6.0)
    assert noticed(ride, "tracking error: left", 4.5) < NOTICED_S
    assert ride.fastest(5.5, 6.0) < 0.01, "the other wheel has been stopped"


def test_a_drive_that_goes_on_slowly_does_not_follow(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.1),
        step(6.5, speed_mps=0.4),
        seconds=20,
        faults=[fault("set_points_ignored", 6.0, node="left")],
    )
    ride.runs_until(8.0)
    assert noticed(ride, "tracking error: left", 6.5) < NOTICED_S


def test_a_steering_that_ignores_its_target_does_not_follow(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.2),
        step(5.0, steer_deg=20),
        step(8.0, speed_mps=0.0, steer_deg=-20),
        seconds=20,
        faults=[fault("set_points_ignored", 7.0, node="steer")],
    )
    ride.runs_until(10.0)
    assert ride.held_between(5.5, 8.0) == set()
    assert noticed(ride, "position not changing: steer", 8.0) < NOTICED_S


def commanded_by_another(ride: Ride, rpm: dict[str, int], began: float, ended: float) -> None:
    """Let a third party send these speeds to enabled drives, ten times as often as the bridge."""
    master = ride.rig.world.attach("second controller", ForeignNode(), {CAN: ride.rig.can_wire})
    nodes = {axis.name: Epos2Axis.of(axis).node for axis in RARS.axes}
    for at in range(from_seconds(began), from_seconds(ended), 5 * MILLISECOND):
        ride.runs_until(to_seconds(at))
        for name, speed in rpm.items():
            frame = SET_POINT[CommandForm.SPEED].pack(0x000F, speed)
            address = SET_POINT_COB_ID[CommandForm.SPEED] + nodes[name]
            ride.rig.can_wire.carry(master, Packet(CAN, address, frame))


@pytest.fixture(params=[(3000, 3000), (2000, -2000), (-2000, 2000)], ids=["ahead", "left", "right"])
def another(rides: Ridden, request: pytest.FixtureRequest) -> Ride:
    """Another master drives the disarmed robot, or has it spin, from second 5 on."""
    left, right = request.param
    ride = rides(
        ARMED,
        step(4.5, disarm=True),
        step(5.2, arm=True),
        step(5.3, lift_m=0.05),
        step(6.0, arm=True),
        seconds=20,
        robot=RARS,
    )
    commanded_by_another(ride, {"left": left, "right": right}, 5.0, 7.0)
    return ride


@pytest.mark.long(keeps=["ahead"])
def test_another_master_does_not_drive_a_disarmed_robot_for_long(another: Ride) -> None:
    moved = noticed(another, "uncommanded motion: left", 5.0)
    assert moved < NOTICED_S
    assert noticed(another, "uncommanded motion: right", 5.0) < NOTICED_S
    assert not any(row["armed"] for row in another.rows(5.0, 7.0)), "wheels that turn are not armed"
    assert max(row["lift_m"] for row in another.rows(5.0, 7.0)) < 0.001, "nor is the lift raised"
    assert another.fastest(6.5, 7.0) < 0.35, "its power goes with each of the bridge's frames"


def test_wheels_that_spin_are_no_rest(rides: Ridden) -> None:
    """Both wheels turn at 2000 rpm against each other, and their mean stands."""
    ride = rides(
        ARMED,
        step(4.0, disarm=True),
        step(4.4, arm=True),
        seconds=20,
        robot=RARS,
    )
    commanded_by_another(ride, {"left": 2000, "right": -2000}, 4.2, 4.45)
    assert abs(ride.now["motor_speed_left_rad_s"] - ride.now["motor_speed_right_rad_s"]) > 100.0
    assert not any(row["armed"] for row in ride.rows(4.3, 4.45))
    answers = [entry.text for entry in ride.operator.diary.entries if entry.at >= from_seconds(4.4)]
    assert "arm: temporarily rejected" in answers or "arm: denied" in answers


def test_a_battery_that_stays_low_stops_the_robot_and_lets_no_one_arm(rides: Ridden) -> None:
    ride = rides(
        ARMED,
        step(4.0, speed_mps=0.2),
        step(18.0, speed_mps=0.0),
        step(19.0, arm=True),
        seconds=30,
        faults=[fault("supply_sag", 5.0, to_v=18.0)],
    )
    ride.runs_until(15.0)
    assert ride.held_between(5.0, 14.5) == set()
    assert ride.now["speed_mps"] == pytest.approx(0.2, rel=0.02)
    ride.runs_until(20.0)
    assert (
        15.0 < to_seconds(next(h.began for h in ride.rig.interlock_events if h.name == "battery low")) < 16.2
    )
    assert ride.fastest(17.0, 20.0) < 0.002
    assert not ride.now["armed"]
    assert ride.hardest(15.0) < 1.45


# What is ordinary


def beside(known: Tracking) -> float:
    """Return how far an axis was beside its range; negative within it."""
    does = known.position if isinstance(known.set_point, Position) else known.velocity
    return max(known.low - does, does - known.high)


@pytest.mark.long(beside="test_its_missions_drive_without_a_refusal_and_it_ends_without_power")
@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("name", "mission", "floor"),
    [
        ("rars", "line", None),
        ("rars", "interlocks", None),
        ("rars", "interlocks", 0.15),
        ("diff_drive", "figure_eight", None),
        ("diff_drive", "interlocks", 0.15),
    ],
)
def test_no_ordinary_mission_comes_near_a_bound(
    name: str,
    mission: str,
    floor: float | None,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """On the thesis's floor, and on one of half its grip: half of each bound at the most, at any sample."""
    robot = find(name)
    if floor is not None:
        plant = robot.plant.model_copy(update={"parameters": {"floor_friction": floor}})
        robot = robot.model_copy(update={"plant": plant})
    bounds = {axis.name: bounds_of(robot, axis) for axis in robot.axes}
    worst = dict.fromkeys(bounds, 0.0)
    saw = Followers.saw

    def measured(self: Followers, axes: Mapping[str, Feedback]) -> dict[str, Tracking]:
        known = saw(self, axes)
        for axis, one in known.items():
            if axes[axis].power is not Power.ON or one.changed_at == NEVER_RECEIVED:
                continue
            by_position = isinstance(one.set_point, Position)
            bound = bounds[axis].position if by_position else bounds[axis].speed
            worst[axis] = max(worst[axis], beside(one) / bound, one.backlog / bounds[axis].creep)
        return known

    monkeypatch.setattr(Followers, "saw", measured)
    script = mission_of(robot, mission)
    with scripted(robot, script, noise=script.noise) as rig:
        rig.run(from_seconds(script.duration_s))
        assert [event.name for event in rig.interlock_events if event.name.startswith(WATCHED)] == []
    assert max(worst.values()) < 0.5
