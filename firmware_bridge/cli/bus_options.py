"""What the options of `monitor` and `explain` state of a CAN bus: robot, families of nodes, data sheets."""

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Final, Protocol, TypeAlias

import typer

from firmware_bridge.cli.commands import completing
from firmware_bridge.cli.console import one_message, refusal

if TYPE_CHECKING:
    from collections.abc import Mapping

    from firmware_bridge.canopen.address import Address
    from firmware_bridge.canopen.object_row import ObjectRow
    from firmware_bridge.dissector.expected import Expected

BIT_RATE: Final = 1_000_000
"""Bit rate in bit/s, where neither the robot file nor an option gives it."""

BusRobotOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="ROBOT",
        help="Robot on the bus: a name that `robots` lists, or the path of a robot file.",
        show_default=False,
        autocompletion=completing("firmware_bridge.cli.robot_argument:names"),
    ),
]
BusLinkOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="NAME", help="The bus of a robot with several CAN buses.", show_default="the only one"
    ),
]
DeviceOption: TypeAlias = Annotated[
    str | None,
    typer.Option(
        metavar="FAMILY",
        help="Family of nodes whose PDO mapping was not seen to be written, as epos2: they have "
        "its defaults.",
        show_default="by the vendor number that a node reports (0x1018:1), else not known",
    ),
]
EdsOption: TypeAlias = Annotated[
    Path | None,
    typer.Option(metavar="FILE", help="Electronic data sheet with such defaults.", show_default=False),
]
DcfOption: TypeAlias = Annotated[
    list[Path] | None,
    typer.Option(
        metavar="FILE", help="Device configuration file of a node; may be repeated.", show_default=False
    ),
]


class BusOptions(Protocol):
    """The options of a command that reads a bus."""

    @property
    def robot(self) -> str | None:
        """Robot on it."""

    @property
    def link(self) -> str | None:
        """Its link of that robot."""

    @property
    def bit_rate(self) -> int | None:
        """In bit/s."""

    @property
    def device(self) -> str | None:
        """Family of its nodes."""

    @property
    def eds(self) -> Path | None:
        """Data sheet of its nodes."""

    @property
    def dcf(self) -> list[Path] | None:
        """Configurations of its nodes."""


@dataclass(frozen=True, slots=True)
class StatedBus:
    """A bus as its options state it."""

    bit_rate: int
    expected: "tuple[Expected, ...]"
    """Nodes by a robot file and by configuration files."""
    sheet: "Mapping[Address, int] | None"
    device: str
    """Family of unknown nodes; empty where none was named."""


def stated_bus(given: BusOptions) -> StatedBus:
    """Read the options; an error ends the program with a message."""
    device, sheet, configured = _device(given), _sheet(given), _configured(given)
    if given.robot is None:
        if given.link is not None:
            raise refusal(f"--link {given.link}: only a robot has links; use --robot, too")
        return StatedBus(given.bit_rate or BIT_RATE, configured, sheet, device)
    # With them come pydantic and every installed robot.
    from firmware_bridge.cli.robot_argument import find_robot
    from firmware_bridge.dissector.expected import can_links, expected_on

    robot = find_robot(given.robot)
    links = can_links(robot)
    if not links:
        raise refusal(f"--robot {given.robot}: {robot.name} has no drives on a CAN bus; leave --robot out")
    link = links[0] if given.link is None and len(links) == 1 else given.link
    if link not in links:
        raise refusal(f"{robot.name} is on these buses: {', '.join(links)}; select one with --link")
    # Without the right bit rate the load would be wrong; the frames are decoded all the same.
    rate = given.bit_rate or robot.links[link].rate
    return StatedBus(rate, (*expected_on(robot, link), *configured), sheet, device)


def _device(given: BusOptions) -> str:
    if given.device is None:
        return ""
    from firmware_bridge.dissector.dictionary import dictionaries

    known = dictionaries()
    if given.device not in known:
        raise refusal(f"--device {given.device}: there is {', '.join(known)}; for any other use --eds FILE")
    return given.device


def _rows(given: BusOptions) -> "Mapping[Address, ObjectRow]":
    """Return the objects that a data sheet may have: the named family's, or those of all."""
    from firmware_bridge.dissector.dictionary import dictionaries

    named, every = _device(given), dictionaries()
    return {at: row for name in ([named] if named else every) for at, row in every[name].rows.items()}


def _sheet(given: BusOptions) -> "Mapping[Address, int] | None":
    if given.eds is None:
        return None
    from firmware_bridge.runtime.data_sheets import SheetError, defaults

    with one_message(SheetError):
        return defaults(given.eds, _rows(given)).values


def _configured(given: BusOptions) -> "tuple[Expected, ...]":
    """Return the nodes of configuration files; one that names none ends the program with a message."""
    if not given.dcf:
        return ()
    from firmware_bridge.dissector.expected import Expected
    from firmware_bridge.runtime.data_sheets import SheetError, configured

    found, rows = [], _rows(given)
    for file in given.dcf:
        with one_message(SheetError):
            sheet = configured(file, rows)
        if not sheet.node:
            raise refusal(f"--dcf {file}: it names no node; give [DeviceComissioning] its NodeID")
        # As if a controller had written these values, so that the PDOs' mapping is known.
        written = tuple((address, rows[address].type.encode(v)) for address, v in sheet.values.items())
        found.append(Expected(sheet.node, "", written))
    return tuple(found)
