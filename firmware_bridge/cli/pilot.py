"""`pilot`: a ground station that drives, over the operator's link."""

from contextlib import closing
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.live_page import LiveOption, end_in_order, page_port
from firmware_bridge.cli.options import DurationOption, MaxDelayOption, RobotArgument, until

if TYPE_CHECKING:
    from collections.abc import Callable

    from firmware_bridge.motion.model import MotionModel
    from firmware_bridge.pilot.driver import Driver
    from firmware_bridge.pilot.paths import Path as Way
    from firmware_bridge.robot import AnyRobot
    from firmware_bridge.robot_type import AnyRobotType
    from firmware_bridge.runtime.ports import Port


EXAMPLES: Final = """Examples:

`firmware-bridge pilot rars --joystick`

`firmware-bridge pilot rars --joystick --device /dev/input/js1 --controls gamepad`

`firmware-bridge pilot rars --keyboard --telemetry cycle`

`firmware-bridge pilot rars --path circle --size 2 --speed 0.3 --predictor --arm`

`firmware-bridge pilot rars --keyboard --view predicted`"""

VIEWS: Final = ("link", "video", "predicted")


@dataclass(frozen=True, slots=True, kw_only=True)
class PilotOptions:
    """Drive a robot over its operator's link: by hand, or along a path.

    Its bridge calls this machine, as `drive` does by default; received data are shown.

    Ends on Ctrl-C: the controls go to neutral, and the robot is disarmed. If the joystick is lost,
    nothing more is sent, and the bridge stops the robot on the operator link timeout.
    """

    robot: RobotArgument
    mavlink: Annotated[
        str, typer.Option(metavar="LINK", help="Address of the bridge: udpin:HOST:PORT or udpout:HOST:PORT.")
    ] = "udpin:127.0.0.1:14550"
    joystick: Annotated[
        bool,
        typer.Option(
            "--joystick",
            help="Drive with a helm and two pedals; buttons: reverse, arm, emergency stop, the robot's "
            "switches.",
        ),
    ] = False
    device: Annotated[str, typer.Option(metavar="DEVICE", help="The joystick.")] = "/dev/input/js0"
    controls: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Type of the joystick: pedals, with a helm, or gamepad. One that presents itself as a "
            "gamepad must be named so.",
            show_default="pedals",
        ),
    ] = None
    keyboard: Annotated[
        bool,
        typer.Option(
            "--keyboard", help="Drive with this terminal's keys, which must be held down; Enter stops."
        ),
    ] = False
    path: Annotated[
        str | None,
        typer.Option(
            metavar="NAME|FILE",
            help="Follow a path by pure pursuit: line, circle, eight, or a .csv file of points (x,y).",
        ),
    ] = None
    size: Annotated[float, typer.Option(min=0.1, metavar="M", help="Length of the line, or the radius.")] = (
        5.0
    )
    speed: Annotated[
        float, typer.Option(min=0.01, metavar="M_S", help="Speed along the path, or by keys.")
    ] = 0.3
    look_ahead: Annotated[
        float,
        typer.Option(
            "--look-ahead", min=0.05, metavar="M", help="Look-ahead distance to the goal on the path."
        ),
    ] = 0.5
    predictor: Annotated[
        bool, typer.Option("--predictor", help="Steer by the predicted pose at the arrival of the command.")
    ] = False
    arm: Annotated[
        bool,
        typer.Option(
            "--arm", help="Arm the robot when its heartbeat is received. IT MOVES where a path is given."
        ),
    ] = False
    telemetry: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="Messages that are sent: usual, or cycle, all 20 times a second.",
        ),
    ] = "usual"
    key: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Sign all messages with the key in this file, as `drive --key`, and accept only messages "
            "signed with it.",
            show_default="unsigned",
        ),
    ] = None
    view: Annotated[
        str,
        typer.Option(
            metavar="NAME",
            help="What the robot is seen by: link, each pose as it comes; video, two pictures a second, "
            "each 0.5 s old; predicted, those pictures moved to the newest pose. The last two show a "
            "picture: posts in a room that stands for the robot's.",
        ),
    ] = "link"
    view_to: Annotated[
        Path | None,
        typer.Option(
            "--view-to",
            metavar="FILE",
            help="Keep the picture in this .png file in place of a window.",
            show_default="a window",
        ),
    ] = None
    max_delay: MaxDelayOption = None
    live: LiveOption = False
    duration: DurationOption = None


def run(given: PilotOptions) -> None:
    """Run `pilot` with these options; an error ends the program with a message."""
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.cli.remembered import Remembered, Remembering
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.cli.trusted import key_in
    from firmware_bridge.mavlink.trust import Trust
    from firmware_bridge.node import OPERATOR, Node
    from firmware_bridge.pilot.cockpit import HAND, Cockpit
    from firmware_bridge.pilot.driver import AtHand
    from firmware_bridge.pilot.keyboard import HELP
    from firmware_bridge.pilot.profiles import PROFILES
    from firmware_bridge.pilot.station import PilotStation
    from firmware_bridge.pilot.video import Video
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.robot.problems import near
    from firmware_bridge.robot_types import robot_type_of
    from firmware_bridge.runtime.clock import Clock
    from firmware_bridge.runtime.last_places import usual_path
    from firmware_bridge.runtime.ports import UdpPort

    with one_message(RobotFileError):
        robot = find_robot(given.robot).agreed_on(given.max_delay)
    if given.telemetry not in PROFILES:
        raise refusal(
            f"--telemetry {given.telemetry}: no such profile; {near(given.telemetry, list(PROFILES))}"
        )
    _check_view(given)
    robot_type = robot_type_of(robot)
    driver = _driver(given, robot, robot_type)
    hand = {HAND: _device(given)} if isinstance(driver, AtHand) else {}
    operator = robot.operator
    # Signatures are dated by real time, whatever the monotonic clock shows.
    trust = Trust(key=None if given.key is None else key_in(given.key), started_at=Clock().started_at)
    remembered = Remembered(trust, usual_path(f"{robot.name}.pilot").with_suffix(".stamps.json"))
    station = PilotStation(
        driver,
        (operator.system_id, operator.component_id),
        trust=remembered.trust,
        requests=PROFILES[given.telemetry],
        video=Video() if given.view == "video" else None,
    )
    rolling = robot_type.kinematics(robot).rolling
    cockpit = Cockpit(station, say, arms=given.arm, rolling=rolling)
    node: Node = Remembering(cockpit, remembered, station.stamps, say)
    page: dict[str, Callable[[], Port]] = {}
    if given.live:
        from firmware_bridge.live.messages import LIVE
        from firmware_bridge.live.pilot import LivePilot

        page = {LIVE: page_port}
        node = LivePilot(node, station, robot, rolling, end_in_order)
    if given.view != "link":
        from firmware_bridge.pilot.viewing import VIEW, Viewing
        from firmware_bridge.runtime.ports.view_window import ViewWindow

        page |= {VIEW: partial(ViewWindow, given.view_to)}
        node = Viewing(node, station, Video(), predicted=given.view == "predicted")
    keys = f"; {HELP}" if given.keyboard else ""
    carry(
        node,
        {OPERATOR: partial(UdpPort, given.mavlink), **hand, **page},
        until(given.duration),
        f"{robot.name}: pilot on {given.mavlink}{keys}",
    )


def _check_view(given: PilotOptions) -> None:
    from firmware_bridge.robot.problems import near

    if given.view not in VIEWS:
        raise refusal(f"--view {given.view}: no such view; {near(given.view, list(VIEWS))}")
    if given.view_to is not None and given.view == "link":
        raise refusal("--view-to: there is a picture with --view video and --view predicted only")


def _driver(given: PilotOptions, robot: "AnyRobot", robot_type: "AnyRobotType") -> "Driver":
    from firmware_bridge.motion.model import Unicycle
    from firmware_bridge.pilot.driver import Extras
    from firmware_bridge.pilot.follower import PathDriver
    from firmware_bridge.pilot.hand import StickInput
    from firmware_bridge.pilot.joystick import DEVICES, Controls
    from firmware_bridge.pilot.keyboard import Keyboard
    from firmware_bridge.pilot.paths import PathError, placed
    from firmware_bridge.pilot.predictor import Predictor

    if (given.joystick, given.keyboard, given.path is not None).count(True) != 1:
        raise refusal("choose the controls: --joystick, --keyboard, or --path NAME; one of them")
    fastest = robot_type.station.largest(robot).forward_mps
    if given.path is None:
        station = robot_type.station
        switches = tuple(switch.button for switch in station.switches if switch.button is not None)
        extras = Extras(switches, station.up_button)
        if given.keyboard:
            return Keyboard(min(given.speed / fastest, 1.0), extras)
        return StickInput(Controls(DEVICES[_controls(given)]), extras)
    with one_message(PathError):
        path = _path(given.path, given.size)
    model: MotionModel = Unicycle() if robot_type.model is None else robot_type.model(robot)
    return PathDriver(
        lambda pose: placed(path, pose),
        # An agreed delay lowers the top speed: speed times age stays constant.
        speed_mps=min(given.speed, robot.operator.speed_share * fastest),
        look_ahead_m=given.look_ahead,
        tightest_per_m=model.tightest_per_m,
        predictor=Predictor(model) if given.predictor else None,
    )


def _controls(given: PilotOptions) -> str:
    """Return the type of the joystick; a gamepad by its own name is not taken for pedals.

    A trigger at standstill would be a pedal that is trodden down.
    """
    from firmware_bridge.pilot.joystick import DEVICES, USUAL, is_gamepad
    from firmware_bridge.robot.problems import near
    from firmware_bridge.runtime.ports import PortError
    from firmware_bridge.runtime.ports.joystick import JoystickPort, identity

    if given.controls is None:
        with one_message(PortError), closing(JoystickPort(given.device)) as port:
            name, codes = identity(port.fileno())
        if is_gamepad(name, codes):
            other = f"--controls gamepad, or {USUAL} where it is none"
            raise refusal(f"--device {given.device}: '{name}' is a gamepad; use {other}")
        return USUAL
    if given.controls not in DEVICES:
        raise refusal(f"--controls {given.controls}: no such device; {near(given.controls, list(DEVICES))}")
    return given.controls


def _path(name: str, size: float) -> "Way":
    from firmware_bridge.pilot import path_file
    from firmware_bridge.pilot.paths import PATHS, PathError
    from firmware_bridge.robot.problems import near

    if name in PATHS:
        return PATHS[name](size)
    if name.endswith(".csv"):
        return path_file.load(Path(name))
    raise PathError(f"there is no path '{name}'; {near(name, list(PATHS))} (or a file that ends in .csv)")


def _device(given: PilotOptions) -> "Callable[[], Port]":
    from firmware_bridge.runtime.ports.joystick import JoystickPort
    from firmware_bridge.runtime.ports.keyboard import KeyboardPort

    return KeyboardPort if given.keyboard else partial(JoystickPort, given.device)


pilot: Final = command(EXAMPLES, work=run)(PilotOptions)
