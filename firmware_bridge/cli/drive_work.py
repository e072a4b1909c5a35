"""Runs the bridge on real links, telling the user what it does."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import Final

from firmware_bridge.bridge import Bridge
from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.cli.drive import DriveOptions
from firmware_bridge.cli.narrated import Narrated, StartUpFailedError, not_confirmed
from firmware_bridge.cli.options import generation_of, until
from firmware_bridge.cli.places import Place, parted, places_of
from firmware_bridge.cli.real_time import carry
from firmware_bridge.cli.recorded import recording
from firmware_bridge.cli.remembered import Remembered
from firmware_bridge.cli.robot_argument import find_robot
from firmware_bridge.cli.trusted import trust_of
from firmware_bridge.cli.watchdogs import watched
from firmware_bridge.cli.zeros import zeros_of
from firmware_bridge.drivers.epos2.serial.fleet import over_serial
from firmware_bridge.drivers.epos2.serial.line import MaxonLine
from firmware_bridge.drivers.epos2.serial.plan import PlanError
from firmware_bridge.drivers.shield.fleet import measured, over_protocol
from firmware_bridge.drivers.shield.plan import ShieldPlanError
from firmware_bridge.kind import AnyKind
from firmware_bridge.kinds import kind_of
from firmware_bridge.node import OPERATOR, Node
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.robot.path_file import PathFileError, along_path
from firmware_bridge.robot.problems import near
from firmware_bridge.robot.settings.ar2 import Ar2Link
from firmware_bridge.robot.settings.epos2 import Epos2Driver, Epos2Link
from firmware_bridge.robot.settings.shield import ShieldLink
from firmware_bridge.safety.guard import guarded
from firmware_bridge.shell.black_box import CAN_LOG, CAPTURE_LOG, OPERATOR_LOG, SERIAL_LOG, Texts
from firmware_bridge.shell.last_places import LastPlaces, usual_path
from firmware_bridge.shell.ports import Port, ReturningLine, UdpPort, open_can
from firmware_bridge.slow_link.conditions import Conditions
from firmware_bridge.slow_link.node import before_robot
from firmware_bridge.teleop.mavlink import Codec, dialect
from firmware_bridge.teleop.texts import Listener
from firmware_bridge.wire.maxon.frame import Generation

_OTHER: Final = {Generation.V1: Generation.V2, Generation.V2: Generation.V1}


def drive(given: DriveOptions) -> None:
    """Do what `drive` says; what is wrong ends the program with a message."""
    machine = find_robot(given.robot)
    named, slow = parted(machine, given.link)
    places = places_of(machine, named, Place(given.interface, given.channel, given.serial))
    trust = trust_of(given.mavlink, given.key, given.allow, openly=given.openly)
    state = given.state or usual_path(machine.name)
    stamps = Remembered(trust, state.with_suffix(".stamps.json"))
    stands = zeros_of(given.zero, given.home)
    with one_message(PlanError, ShieldPlanError, RobotFileError, PathFileError, ValueError):
        machine = (
            watched(_with_lines(machine, places, given), accepted=given.accept_no_watchdog)
            .told_by(given.bandwidth)
            .agreed_on(given.max_delay)
        )
        machine, _ = along_path(machine, given.path, given.path_speed)
        kind = kind_of(machine)
        bridge = Bridge(machine, kind, stamps.trust, stands, _mode(given.mode, kind))
    kept = LastPlaces(state)
    bridge.offer(kept.read())
    node: Node = guarded(bridge, machine)
    openers: dict[str, Callable[[], Port]] = {}
    lines: list[str] = []
    hints: dict[str, str] = {}
    for name, place in places.items():
        table = machine.links[name]
        if isinstance(table, ShieldLink | Ar2Link):
            openers[name] = _serial_opener(machine, place, table.line_rate)
            lines.append(name)
            hints[name] = _no_board(table)
        elif table.driver is Epos2Driver.SERIAL:
            node = MaxonLine(node, table.protocol, name)
            openers[name] = _serial_opener(machine, place, table.line_rate)
            lines.append(name)
            hints[name] = _nothing_heard(table.protocol, table.line_rate)
        elif isinstance(table, Epos2Link):
            rate = given.bit_rate or table.bit_rate
            openers[name] = _can_opener(place, given.bit_rate, table.bit_rate)
            hints[name] = (
                f"nothing was heard on {place.title}: are the drives on, at {rate} bit/s (--bitrate)?"
            )
    for name, system in machine.capture_links.items():
        openers[name] = partial(UdpPort, f"udpin:{system.listen}")
    where = ", ".join(_title(machine, name, place) for name, place in places.items())
    files = {name: SERIAL_LOG if name in lines else CAN_LOG for name in places}
    files |= dict.fromkeys(machine.capture_links, CAPTURE_LOG) | {OPERATOR: OPERATOR_LOG}
    try:
        with recording(given.record, files, texts_of()) as (around, tell):
            carried = _far(around(node), slow)
            carry(
                Narrated(bridge, carried, machine, tell, kept=kept, stamps=stamps, hints=hints),
                {**openers, OPERATOR: lambda: UdpPort(given.mavlink)},
                until(given.duration),
                f"{machine.name}: bridge on {where}, operator on {given.mavlink}",
                StartUpFailedError,
                unfinished=lambda: not_confirmed(bridge),
            )
    finally:
        for problem in filter(None, (kept.file.settled(), stamps.settled())):
            say(f"firmware-bridge: {problem}", err=True)


def _far(node: Node, slow: Conditions | None) -> Node:
    """Return the bridge behind a slow link; what it hears there is recorded, so that it plays again."""
    if slow is None:
        return node
    # A tenth of a second for NumPy, which only who trains needs.
    from numpy.random import default_rng  # noqa: PLC0415 - see above

    return before_robot(node, OPERATOR, slow, default_rng([0, 0]), default_rng([0, 1]))


def texts_of() -> Texts:
    """Return what reads the bridge's texts out of its datagrams, whole."""
    codec, listener = Codec(0, 0), Listener()
    wanted = frozenset({dialect.MAVLINK_MSG_ID_STATUSTEXT})

    def read(datagram: bytes) -> Iterator[str]:
        for message in codec.decode(datagram, wanted):
            for heard in listener.hear(message):
                yield heard.text

    return read


def _mode(name: str | None, kind: AnyKind) -> str:
    if name is not None and name not in kind.modes:
        known = near(name, list(kind.modes)) if kind.modes else "this robot has none"
        raise refusal(f"--mode {name}: no such mode; {known}")
    return name or ""


def _with_lines(machine: AnyRobot, places: Mapping[str, Place], given: DriveOptions) -> AnyRobot:
    """Return the robot with those links on serial lines that are at a serial port."""
    if machine.shield_links:
        spoken = given.protocol and given.protocol.value
        return measured(over_protocol(machine, spoken, given.encoders))
    if machine.ar2_links:
        if given.protocol is not None or given.baud is not None:
            raise refusal("--protocol and --baud: the board of an AR2 speaks one language, at one rate")
        return machine
    protocol, baud = generation_of(given.protocol), given.baud
    on_lines = [name for name, place in places.items() if place.device is not None]
    serial = any(table.driver is Epos2Driver.SERIAL for table in machine.links.values())
    if not on_lines and not serial:
        if protocol is not None or baud is not None:
            raise refusal("--protocol and --baud are of a serial port; name it with --serial DEVICE")
        return machine
    return over_serial(machine, protocol, baud, links=on_lines or None)


def _no_board(table: ShieldLink | Ar2Link) -> str:
    if isinstance(table, Ar2Link):
        return (
            f"nothing was heard on the line at {table.line_rate} Bd: is the board on, and was it flashed "
            "with AR2 2.0?"
        )
    return (
        f"nothing was heard on the line at {table.line_rate} Bd: is the board on, and was it flashed with "
        f"{table.protocol.value} (--protocol)?"
    )


def _serial_opener(machine: AnyRobot, place: Place, rate: int) -> Callable[[], Port]:
    device = place.device
    if device is None:
        raise refusal(f"{machine.name} is driven over a serial line; name its port with --serial DEVICE")
    return lambda: ReturningLine(device, rate)


def _nothing_heard(spoken: Generation, rate: int) -> str:
    other = _OTHER[spoken]
    return (
        f"nothing was heard on the line, which was spoken to in {spoken.value} at {rate} Bd: is the drive "
        f"on, and is it not {other.value} (--protocol {other.value})?"
    )


def _can_opener(place: Place, bit_rate: int | None, default: int) -> Callable[[], Port]:
    return lambda: open_can(place.interface, place.channel, bit_rate, default_bit_rate=default)


def _title(machine: AnyRobot, name: str, place: Place) -> str:
    table = machine.links[name]
    if isinstance(table, ShieldLink):
        return f"{place.title} ({table.protocol.value}, {table.line_rate} Bd)"
    if table.driver is not Epos2Driver.SERIAL:
        return place.title
    line = f"{table.protocol.value}, {table.line_rate} Bd"
    return f"{place.title} ({line}), node {table.gateway} passes on to the others"
