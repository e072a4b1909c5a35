"""Sits a hand or a path follower at a station, and opens its link."""

from functools import partial
from pathlib import Path as FilePath

from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.options import until
from firmware_bridge.cli.pilot import PilotOptions
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.kinds import kind_of
from firmware_bridge.motion.model import Model, Unicycle
from firmware_bridge.node import OPERATOR
from firmware_bridge.pilot import path_file
from firmware_bridge.pilot.cockpit import JOYSTICK, Cockpit
from firmware_bridge.pilot.driver import Driver
from firmware_bridge.pilot.follower import Follower
from firmware_bridge.pilot.hand import Hand
from firmware_bridge.pilot.joystick import DEVICES, Controls
from firmware_bridge.pilot.paths import PATHS, Path, PathError, placed
from firmware_bridge.pilot.predictor import Predictor
from firmware_bridge.pilot.station import Station
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.problems import near
from firmware_bridge.shell.ports import UdpPort
from firmware_bridge.shell.ports.joystick import JoystickPort


def pilot(given: PilotOptions) -> None:
    """Do what `pilot` says; what is wrong ends the program with a message."""
    with one_message(RobotFileError):
        robot = find_robot(given.robot).agreed_on(given.max_delay)
    driver = _driver(given, robot)
    joystick = {JOYSTICK: partial(JoystickPort, given.device)} if given.joystick else {}
    operator = robot.operator
    station = Station(driver, (operator.system_id, operator.component_id))
    carry(
        Cockpit(station, say, arms=given.arm),
        {OPERATOR: partial(UdpPort, given.mavlink), **joystick},
        until(given.duration),
        f"{robot.name}: pilot on {given.mavlink}",
    )


def _driver(given: PilotOptions, robot: AnyRobot) -> Driver:
    if given.joystick == (given.path is not None):
        raise refusal("say who drives: --joystick, or --path NAME; one of them")
    if given.path is None:
        if given.controls not in DEVICES:
            raise refusal(
                f"--controls {given.controls}: no such device; {near(given.controls, list(DEVICES))}"
            )
        return Hand(Controls(DEVICES[given.controls]))
    with one_message(PathError):
        path = _path(given.path, given.size)
    kind = kind_of(robot)
    model: Model = Unicycle() if kind.model is None else kind.model(robot)
    fastest = robot.operator.speed_share * kind.station.largest(robot).forward_mps
    return Follower(
        lambda pose: placed(path, pose),
        speed_mps=min(given.speed, fastest),
        look_ahead_m=given.look_ahead,
        tightest_per_m=model.tightest_per_m,
        predictor=Predictor(model) if given.predictor else None,
    )


def _path(name: str, size: float) -> Path:
    if name in PATHS:
        return PATHS[name](size)
    if name.endswith(".csv"):
        return path_file.load(FilePath(name))
    raise PathError(f"there is no path '{name}'; {near(name, list(PATHS))}, or a file that ends in .csv")
