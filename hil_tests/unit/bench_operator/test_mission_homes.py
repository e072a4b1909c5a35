"""The key `home` in a mission's step: the axes that a robot homes, and the station's request for it."""

import math

import pytest

from emulators.bench import mission as missions
from emulators.bench.mission import Mission, MissionFileError
from emulators.bench.orders import CONFIRM, of_step
from emulators.robots.rars import BENCH_SETUP
from firmware_bridge.robot import AnyRobot
from hil_tests.scenarios.homed import LIFT, STEER, homed

ROBOT = homed(LIFT, STEER)
TEXT = 'title = "t"\nduration_s = 10.0\n[[step]]\nat_s = 1.0\ntitle = "s"\nhome = {roles}\n'


def parse(roles: str, robot: AnyRobot = ROBOT) -> Mission:
    return missions.parse(TEXT.format(roles=roles), "my.toml", robot, BENCH_SETUP)


def test_each_is_requested_by_its_place_and_no_number() -> None:
    (step,) = parse('["lift", "steering"]').step
    orders = list(of_step(step, ROBOT, 0))
    assert [(order.title, order.number, order.params[0]) for order in orders] == [
        ("homing of lift", CONFIRM, 4),
        ("homing of steering", CONFIRM, 3),
    ]
    assert all(math.isnan(order.params[1]) for order in orders)


@pytest.mark.parametrize(
    ("roles", "robot", "reported"),
    [
        ('["lfit"]', ROBOT, "step[0].home[0]: rars does not home 'lfit'; perhaps 'lift'?"),
        ('["left_wheel"]', ROBOT, "step[0].home[0]: rars does not home 'left_wheel'"),
        ('["lift"]', homed(None), "step[0].home[0]: rars does not home 'lift'; there are none"),
        ("[]", ROBOT, "at least 1"),
    ],
)
def test_what_is_not_homed_is_reported(roles: str, robot: AnyRobot, reported: str) -> None:
    with pytest.raises(MissionFileError) as wrong:
        parse(roles, robot)
    assert reported in str(wrong.value)
