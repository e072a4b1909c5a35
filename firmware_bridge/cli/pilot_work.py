"""Sits a hand or a path follower at a station, and opens its link."""

from collections.abc import Callable
from contextlib import closing
from functools import partial
from pathlib import Path as FilePath

from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.options import until
from firmware_bridge.cli.pilot import PilotOptions
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.remembered import Remembered, Remembering
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.cli.trusted import key_in
from firmware_bridge.kind import AnyKind
from firmware_bridge.kinds import kind_of
from firmware_bridge.motion.model import Model, Unicycle
from firmware_bridge.node import OPERATOR
from firmware_bridge.pilot import path_file
from firmware_bridge.pilot.cockpit import HAND, Cockpit
from firmware_bridge.pilot.driver import AtHand, Driver, Extras
from firmware_bridge.pilot.follower import Follower
from firmware_bridge.pilot.hand import Hand
from firmware_bridge.pilot.joystick import DEVICES, USUAL, Controls, is_gamepad
from firmware_bridge.pilot.keyboard import HELP, Keyboard
from firmware_bridge.pilot.paths import PATHS, Path, PathError, placed
from firmware_bridge.pilot.predictor import Predictor
from firmware_bridge.pilot.profiles import PROFILES
from firmware_bridge.pilot.station import Station
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.problems import near
from firmware_bridge.shell.clock import Clock
from firmware_bridge.shell.last_places import usual_path
from firmware_bridge.shell.ports import Port, PortError, UdpPort
from firmware_bridge.shell.ports.joystick import JoystickPort, identity
from firmware_bridge.shell.ports.keyboard import KeyboardPort
from firmware_bridge.teleop.trust import Trust


def pilot(given: PilotOptions) -> None:
    """Do what `pilot` says; what is wrong ends the program with a message."""
    with one_message(RobotFileError):
        robot = find_robot(given.robot).agreed_on(given.max_delay)
    if given.telemetry not in PROFILES:
        raise refusal(
            f"--telemetry {given.telemetry}: no such profile; {near(given.telemetry, list(PROFILES))}"
        )
    kind = kind_of(robot)
    driver = _driver(given, robot, kind)
    hand = {HAND: _device(given)} if isinstance(driver, AtHand) else {}
    operator = robot.operator
    trust = Trust(key=None if given.key is None else key_in(given.key), started_at=Clock().started_at)
    remembered = Remembered(trust, usual_path(f"{robot.name}.pilot").with_suffix(".stamps.json"))
    station = Station(
        driver,
        (operator.system_id, operator.component_id),
        trust=remembered.trust,
        asks=PROFILES[given.telemetry],
    )
    cockpit = Cockpit(station, say, arms=given.arm, rolling=kind.body(robot).rolling)
    keys = f"; {HELP}" if given.keyboard else ""
    carry(
        Remembering(cockpit, remembered, station.stamps, say),
        {OPERATOR: partial(UdpPort, given.mavlink), **hand},
        until(given.duration),
        f"{robot.name}: pilot on {given.mavlink}{keys}",
    )


def _driver(given: PilotOptions, robot: AnyRobot, kind: AnyKind) -> Driver:
    if (given.joystick, given.keyboard, given.path is not None).count(True) != 1:
        raise refusal("say who drives: --joystick, --keyboard, or --path NAME; one of them")
    fastest = kind.station.largest(robot).forward_mps
    if given.path is None:
        station = kind.station
        switches = tuple(switch.button for switch in station.switches if switch.button is not None)
        extras = Extras(switches, station.up_button)
        if given.keyboard:
            return Keyboard(min(given.speed / fastest, 1.0), extras)
        return Hand(Controls(DEVICES[_controls(given)]), extras)
    with one_message(PathError):
        path = _path(given.path, given.size)
    model: Model = Unicycle() if kind.model is None else kind.model(robot)
    return Follower(
        lambda pose: placed(path, pose),
        speed_mps=min(given.speed, robot.operator.speed_share * fastest),
        look_ahead_m=given.look_ahead,
        tightest_per_m=model.tightest_per_m,
        predictor=Predictor(model) if given.predictor else None,
    )


def _controls(given: PilotOptions) -> str:
    """Return what the joystick is; one that says that it is a gamepad is not taken for pedals unasked.

    A trigger that nobody touches would be a pedal that is trodden down.
    """
    if given.controls is None:
        with one_message(PortError), closing(JoystickPort(given.device)) as port:
            name, codes = identity(port.fileno())
        if is_gamepad(name, codes):
            other = f"--controls gamepad, or {USUAL} where it is none"
            raise refusal(f"--device {given.device}: '{name}' is a gamepad; say {other}")
        return USUAL
    if given.controls not in DEVICES:
        raise refusal(f"--controls {given.controls}: no such device; {near(given.controls, list(DEVICES))}")
    return given.controls


def _path(name: str, size: float) -> Path:
    if name in PATHS:
        return PATHS[name](size)
    if name.endswith(".csv"):
        return path_file.load(FilePath(name))
    raise PathError(f"there is no path '{name}'; {near(name, list(PATHS))}, or a file that ends in .csv")


def _device(given: PilotOptions) -> Callable[[], Port]:
    return KeyboardPort if given.keyboard else partial(JoystickPort, given.device)
