"""`drive`: the bridge on a real bus."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final

import typer

from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.live_page import LiveOption, end_in_order, page_port
from firmware_bridge.cli.options import (
    ChannelOption,
    DurationOption,
    EncodersOption,
    HomeOption,
    InterfaceOption,
    LinkOption,
    MaxDelayOption,
    PathOption,
    PathSpeedOption,
    RobotArgument,
    RobotBitRateOption,
    ZeroOption,
    until,
)
from firmware_bridge.cli.plot_option import PlotOption, plotted
from firmware_bridge.cli.recorded import RecordOption, recording
from firmware_bridge.node import OPERATOR, Node
from firmware_bridge.runtime.black_box import CAN_LOG, CAPTURE_LOG, OPERATOR_LOG, SERIAL_LOG, Texts

if TYPE_CHECKING:
    from firmware_bridge.bridge import Bridge
    from firmware_bridge.cli.places import BusAddress
    from firmware_bridge.family import LinkOptions
    from firmware_bridge.robot import AnyRobot
    from firmware_bridge.robot_type import AnyRobotType
    from firmware_bridge.runtime.ports import Port
    from firmware_bridge.slow_link.conditions import Conditions


EXAMPLES: Final = """Examples:

`firmware-bridge drive rars -i socketcan -c can0`

`firmware-bridge drive rars --serial /dev/ttyUSB0` drives over the first drive's USB or RS232 port.

`firmware-bridge drive rome --serial /dev/ttyACM0` drives a board with a motor shield.

`firmware-bridge drive rome --protocol mw --encoders 3 --accept-no-watchdog --serial /dev/ttyACM0`

`firmware-bridge drive rars -i slcan -c /dev/ttyACM0 --mavlink udpout:192.168.1.10:14550 --key rars.key`

`firmware-bridge drive rars -i socketcan -c can0 --link delay=0.5,jitter=0.1` for training

`firmware-bridge drive rars -i socketcan -c can0 --mavlink udpin::14550 --key rars.key --allow 10.0.0.0/24`"""


@dataclass(frozen=True, slots=True, kw_only=True)
class DriveOptions:
    """Run the bridge on a real CAN bus or serial line: find the drives, set them up, and obey the operator.

    Ends on Ctrl-C, Ctrl-Z, or when its terminal is closed: the robot is brought to standstill first,
    then its drives are disabled; a second Ctrl-C does not shorten this. If a serial port is unplugged, the
    bridge waits for it; then the robot must be armed again.

    Exit status 0 after an orderly end, 1 where the run failed or could not start, 2 for a wrong option or a
    missing bus, 3 if at the end a drive has not confirmed that its power stage is disabled.
    """

    robot: RobotArgument
    interface: InterfaceOption = None
    channel: ChannelOption = None
    bit_rate: RobotBitRateOption = None
    mavlink: Annotated[
        str,
        typer.Option(
            metavar="LINK",
            help="The operator's link: udpout:HOST:PORT connects to a station, by default on this machine; "
            "udpin:HOST:PORT waits for one. A link beyond this machine needs --key or --open.",
        ),
    ] = "udpout:127.0.0.1:14550"
    bandwidth: Annotated[
        int | None,
        typer.Option(
            min=4_800,
            metavar="BIT_S",
            help="Rate of the operator's link, as of a telemetry radio's serial line, for instance 57600: "
            "telemetry takes at most half of it.",
            show_default="the robot's",
        ),
    ] = None
    key: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="Accept only messages signed with this key (MAVLink 2), and sign all messages: 64 "
            "hexadecimal digits, or the phrase entered at the station. An emergency stop is accepted from "
            "any station.",
            show_default=False,
        ),
    ] = None
    allow: Annotated[
        list[str] | None,
        typer.Option(
            metavar="ADDRESS",
            help="Accept messages only from this address, or network as 192.168.1.0/24; may be repeated.",
            show_default="all",
        ),
    ] = None
    openly: Annotated[
        bool,
        typer.Option(
            "--open", help="Without a key: let every station that reaches the link drive the robot."
        ),
    ] = False
    serial: Annotated[
        str | None,
        typer.Option(
            "--serial",
            metavar="DEVICE",
            help="Instead of CAN: the serial port of one drive, which passes commands on to the others.",
            show_default=False,
        ),
    ] = None
    baud: Annotated[
        int | None,
        typer.Option(
            min=9_600,
            max=1_000_000,
            help="Bit rate of the serial port, in bit/s.",
            show_default="the robot's",
        ),
    ] = None
    protocol: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Protocol of the serial port: v1 as on RS232, v2 as on USB; for a board with a motor "
            "shield its firmware: mw, ros-arduino-bridge, arduinoio or firmata.",
            show_default="the robot's",
        ),
    ] = None
    encoders: EncodersOption = None
    accept_no_watchdog: Annotated[
        bool,
        typer.Option(
            "--accept-no-watchdog",
            help="Drive a board whose firmware does not stop its motors when the bridge ends or the line is "
            "cut: keep the switch of their supply within reach.",
        ),
    ] = False
    path: PathOption = None
    path_speed: PathSpeedOption = None
    link: LinkOption = None
    max_delay: MaxDelayOption = None
    mode: Annotated[
        str | None,
        typer.Option(
            metavar="NAME",
            help="Begin in this mode after a failed actuator: its device is not used. A wrong name lists "
            "the valid modes.",
            show_default="the whole robot",
        ),
    ] = None
    allow_fault_injection: Annotated[
        bool,
        typer.Option(
            "--allow-fault-injection",
            help="Let the station in control inject failures of the operator's link and of the battery's "
            "sensor (MAV_CMD_INJECT_FAILURE); interlocks and output guard stay as they are.",
        ),
    ] = False
    zero: ZeroOption = None
    home: HomeOption = None
    state: Annotated[
        Path | None,
        typer.Option(
            metavar="FILE",
            help="File of the axis positions for the next run, which offers them for confirmation.",
            show_default="~/.local/state/firmware-bridge/ROBOT.json",
        ),
    ] = None
    record: RecordOption = None
    live: LiveOption = False
    plotjuggler: PlotOption = None
    duration: DurationOption = None


def run(given: DriveOptions) -> None:
    """Run `drive` with these options; an error ends the program with a message."""
    from firmware_bridge.bridge import Bridge
    from firmware_bridge.cli.fitted import driven
    from firmware_bridge.cli.narrated import Narrated, StartUpFailedError, not_confirmed
    from firmware_bridge.cli.places import BusAddress, places_of, split_links
    from firmware_bridge.cli.real_time import carry
    from firmware_bridge.cli.remembered import Remembered
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.cli.trusted import trust_of
    from firmware_bridge.cli.watchdogs import watched
    from firmware_bridge.cli.zeros import zeros_of
    from firmware_bridge.drivers.link_drivers import PlanError
    from firmware_bridge.mcap_file.bridge_watch import BridgeWatch
    from firmware_bridge.robot import RobotFileError
    from firmware_bridge.robot.path_file import PathFileError, along_path
    from firmware_bridge.robot.table import Medium
    from firmware_bridge.robot_types import robot_type_of
    from firmware_bridge.runtime.last_places import LastPlaces, known_places, usual_path
    from firmware_bridge.runtime.ports import UdpPort
    from firmware_bridge.runtime.run_file import AsRun, run_file
    from firmware_bridge.safety.guard import guarded

    machine = find_robot(given.robot)
    named, slow = split_links(machine, given.link)
    places = places_of(machine, named, BusAddress(given.interface, given.channel, given.serial))
    trust = trust_of(given.mavlink, given.key, given.allow, openly=given.openly)
    state = given.state or usual_path(machine.name)
    stamps = Remembered(trust, state.with_suffix(".stamps.json"))
    confirmed = zeros_of(given.zero, given.home)
    with one_message(PlanError, RobotFileError, PathFileError, ValueError):
        machine = (
            # A board without a watchdog is refused before any port is opened.
            watched(driven(machine, _options(given, places)), accepted=given.accept_no_watchdog)
            .discriminated_by(given.bandwidth)
            .agreed_on(given.max_delay)
        )
        machine, _ = along_path(machine, given.path, given.path_speed)
        robot_type = robot_type_of(machine)
        bridge = Bridge(
            machine,
            robot_type,
            stamps.trust,
            confirmed,
            _mode(given.mode, robot_type),
            injects=given.allow_fault_injection,
        )
    # Read before the run overwrites them: they are offered, and never trusted.
    kept = LastPlaces(state)
    places_before = kept.read()
    bridge.offer(places_before)
    # Next to the bridge: lines and recordings stand outside, and see what the guard lets through.
    node: Node = guarded(bridge, machine)
    node, openers, hints = _links(machine, places, given, node)
    where = ", ".join(
        f"{place.title} {machine.links[name].described}".rstrip() for name, place in places.items()
    )
    logs = {Medium.CAN: CAN_LOG, Medium.SERIAL: SERIAL_LOG, Medium.UDP: CAPTURE_LOG}
    files = {name: logs[link.medium] for name, link in machine.links.items()} | {OPERATOR: OPERATOR_LOG}
    try:
        known = known_places(places_before) | run_file(AsRun(machine, confirmed, given.mode or ""))
        watch = BridgeWatch(machine, lambda: bridge)
        with recording(given.record, files, texts_of(), known=known, watch=watch) as (around, show):
            carried = _far(_shown(around(node), bridge, machine, openers, given), slow)
            carry(
                Narrated(bridge, carried, machine, show, kept=kept, stamps=stamps, hints=hints),
                {**openers, OPERATOR: lambda: UdpPort(given.mavlink)},
                until(given.duration),
                f"{machine.name}: bridge on {where}, operator on {given.mavlink}",
                StartUpFailedError,
                unfinished=lambda: not_confirmed(bridge),
            )
    # After a failure, too: these files are for the next run.
    finally:
        for problem in filter(None, (kept.file.settled(), stamps.settled())):
            say(f"firmware-bridge: {problem}", err=True)


def _options(given: DriveOptions, places: "Mapping[str, BusAddress]") -> "LinkOptions":
    from firmware_bridge.family import LinkOptions

    on_lines = tuple(name for name, place in places.items() if place.device is not None)
    return LinkOptions(given.protocol, given.baud, given.encoders, on_lines)


def _links(
    machine: "AnyRobot", places: "Mapping[str, BusAddress]", given: DriveOptions, node: Node
) -> "tuple[Node, dict[str, Callable[[], Port]], dict[str, str]]":
    """Return the bridge behind its ends of the links, the links' openers, and the hints for silence."""
    from firmware_bridge.family import family_of
    from firmware_bridge.robot.table import Medium
    from firmware_bridge.runtime.ports import UdpPort

    openers: dict[str, Callable[[], Port]] = {}
    hints: dict[str, str] = {}
    for name, table in machine.links.items():
        node = family_of(table).line_end(node, table, name)
        match table.medium:
            case Medium.UDP:
                openers[name] = partial(UdpPort, f"udpin:{table.place}")
            case Medium.SERIAL:
                openers[name] = _serial_opener(machine, places[name], table.rate)
                hints[name] = table.silent_hint
            case Medium.CAN:
                place, rate = places[name], given.bit_rate or table.rate
                openers[name] = _can_opener(place, given.bit_rate, table.rate)
                hints[name] = (
                    f"nothing was received on {place.title}: are the drives on, at {rate} bit/s (--bitrate)?"
                )
    return node, openers, hints


def _shown(
    node: Node,
    bridge: "Bridge",
    machine: "AnyRobot",
    openers: "dict[str, Callable[[], Port]]",
    given: DriveOptions,
) -> Node:
    """Return the bridge with the live page and the plotter that the options name, their ports put beside."""
    from firmware_bridge.live.plotted import of_bridge

    node = _on_page(node, bridge, machine, openers) if given.live else node
    return plotted(node, given.plotjuggler, openers, of_bridge(machine, bridge))


def _on_page(
    node: Node, bridge: "Bridge", machine: "AnyRobot", openers: "dict[str, Callable[[], Port]]"
) -> Node:
    """Return the bridge on the live page, whose port is put beside the others."""
    from firmware_bridge.live.messages import LIVE
    from firmware_bridge.live.robot import LiveRobot

    openers[LIVE] = page_port
    return LiveRobot(node, bridge, machine, end_in_order)


def _far(node: Node, slow: "Conditions | None") -> Node:
    """Return the bridge behind a slow link; packets received over it are recorded, for a replay."""
    from firmware_bridge.slow_link.node import before_robot

    if slow is None:
        return node
    # A tenth of a second for NumPy, which only training needs.
    from numpy.random import default_rng

    # A generator for each direction, so that traffic one way leaves the chance of the other as it is.
    return before_robot(node, OPERATOR, slow, default_rng([0, 0]), default_rng([0, 1]))


def texts_of() -> Texts:
    """Return what reads the bridge's texts out of its datagrams, whole."""
    from firmware_bridge.mavlink.frames import Codec, dialect
    from firmware_bridge.mavlink.texts import TextCollector

    codec, listener = Codec(0, 0), TextCollector()
    wanted = frozenset({dialect.MAVLINK_MSG_ID_STATUSTEXT})

    def read(datagram: bytes) -> Iterator[str]:
        for message in codec.decode(datagram, wanted):
            for received in listener.receive(message):
                yield received.text

    return read


def _mode(name: str | None, robot_type: "AnyRobotType") -> str:
    from firmware_bridge.robot.problems import near

    if name is not None and name not in robot_type.modes:
        known = near(name, list(robot_type.modes)) if robot_type.modes else "this robot has none"
        raise refusal(f"--mode {name}: no such mode; {known}")
    return name or ""


def _serial_opener(machine: "AnyRobot", place: "BusAddress", rate: int) -> "Callable[[], Port]":
    from firmware_bridge.runtime.ports import ReturningLine

    device = place.device
    if device is None:
        raise refusal(f"{machine.name} is driven over a serial line; name its port with --serial DEVICE")
    return lambda: ReturningLine(device, rate)


def _can_opener(place: "BusAddress", bit_rate: int | None, default: int) -> "Callable[[], Port]":
    from firmware_bridge.runtime.ports import open_can

    return lambda: open_can(place.interface, place.channel, bit_rate, default_bit_rate=default, say=say)


drive: Final = command(EXAMPLES, work=run)(DriveOptions)
