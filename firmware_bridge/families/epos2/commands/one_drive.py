"""From the options to one drive: the port to open, the way to speak over, and how the drive is called."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import wraps
from inspect import Signature, signature
from typing import Any, Final

from firmware_bridge.canopen.cia301 import ALL_NODES, FIRST_NODE
from firmware_bridge.cli.console import FAILED, INTERRUPTED, one_message, refusal, say
from firmware_bridge.cli.options import BitRateOption, ChannelOption, InterfaceOption
from firmware_bridge.families.epos2.commands.drive_options import (
    BaudOption,
    GatewayOption,
    LineProtocolOption,
    NodeOption,
    SerialPortOption,
)
from firmware_bridge.families.epos2.commissioning.can_access import CanAccess
from firmware_bridge.families.epos2.commissioning.client import JobClient, Overhear, Script
from firmware_bridge.families.epos2.commissioning.error_text import error_text
from firmware_bridge.families.epos2.commissioning.job import JobError
from firmware_bridge.families.epos2.commissioning.network_command import GatewayCheck
from firmware_bridge.families.epos2.commissioning.serial_access import OWN, SerialAccess
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.node import CAN, SERIAL
from firmware_bridge.runtime.clock import Clock
from firmware_bridge.runtime.ports import LostPort, Port, PortError, SerialLine, open_can
from firmware_bridge.runtime.runner import run
from firmware_bridge.units import NEVER, Nanoseconds

_BAUD: Final = {Generation.V1: 115_200, Generation.V2: 1_000_000}
_OTHER: Final = {Generation.V1: "v2", Generation.V2: "v1"}


@dataclass(frozen=True, slots=True)
class OneDrive:
    """One drive, and the way to it."""

    node: int | None
    """None for the drive on a serial line, whichever it is; 0 for all nodes."""
    title: str
    where: str
    """The bus or the line alone."""
    silence: str
    """The checks to make when there is no answer."""
    link: CanAccess | SerialAccess
    opener: Callable[[], Port]
    gateway: int | None = None

    @property
    def alone(self) -> bool:
        """True where the drive is on its own line, with no bus in between."""
        return isinstance(self.link, SerialAccess) and self.link.node in {OWN, self.gateway}

    def converse(
        self, script: Script, until: Nanoseconds = NEVER, overhear: Overhear | None = None
    ) -> JobClient:
        """Carry a script out in real time; what goes wrong ends the program with one message.

        Returns also where the time was over, or the user had enough, before the script was done.
        """
        # Before anything else: through a wrong gateway a command would reach another drive.
        checked = () if self.gateway is None or isinstance(self.link, CanAccess) else self._checked(self.link)
        client = JobClient(self.link, (*checked, *script), overhear)
        with one_message(PortError):
            port = self.opener()
        with one_message(LostPort, status=FAILED):
            run(client, {SERIAL if isinstance(self.link, SerialAccess) else CAN: port}, Clock(), until=until)
        if client.failure is not None:
            raise refusal(self._error_text(client.failure), FAILED)
        return client

    def finish(self, script: Script) -> None:
        """Carry out a script that has an end; to interrupt it ends the program."""
        if not self.converse(script).finished:
            raise refusal(
                f"interrupted; {self.title} is left as the last command that reached it left it", INTERRUPTED
            )

    def _checked(self, link: SerialAccess) -> Script:
        return () if self.gateway is None else GatewayCheck(link, self.gateway).script()

    def _error_text(self, failure: Exception) -> str:
        if isinstance(failure, JobError):
            return error_text(failure, self.title, self.silence)
        return f"{self.title}: {failure}"


def drive_from_options(
    *,
    node: NodeOption = None,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    bit_rate: BitRateOption = None,
    serial: SerialPortOption = None,
    baud: BaudOption = None,
    protocol: LineProtocolOption = None,
    gateway: GatewayOption = None,
) -> OneDrive:
    """Return the way to a drive; options that do not go together end the program with a message."""
    if serial is None:
        _only(
            "a serial line", "--serial DEVICE", {"--baud": baud, "--protocol": protocol, "--gateway": gateway}
        )
        number = FIRST_NODE if node is None else node
        where = channel or "the configured bus"
        return OneDrive(
            number,
            _title(number, where),
            where,
            "is it on, on this bus, at this bit rate, with this --node? In Stopped it is silent, too",
            CanAccess(number),
            lambda: open_can(interface, channel, bit_rate, say=say),
        )
    _only("the CAN bus", "no --serial", {"-i": interface, "-c": channel, "-b": bit_rate})
    spoken = protocol or Generation.V1
    rate = baud or _BAUD[spoken]
    # With --gateway alone the drive on the line is meant, and is checked first.
    wanted = gateway if node is None else node
    return OneDrive(
        wanted,
        f"the drive on {serial}" if wanted is None else _title(wanted, serial),
        serial,
        f"is it on, at {rate} Bd (--baud), and does the line speak {spoken.value}, "
        f"not {_OTHER[spoken]} (--protocol)?",
        SerialAccess(spoken, wanted or OWN),
        lambda: SerialLine(serial, rate),
        gateway,
    )


def _title(node: int, where: str) -> str:
    return f"all nodes on {where}" if node == ALL_NODES else f"node {node} on {where}"


def _only(link: str, instead: str, given: dict[str, object]) -> None:
    """Refuse options of the link that is not in use."""
    wrong = [name for name, value in given.items() if value is not None]
    if wrong:
        raise refusal(f"{', '.join(wrong)}: only {link} has that; use {instead}")


DriveCommand = Callable[..., None]
"""A command whose first argument is the drive."""


def one_drive(node: Any = NodeOption) -> Callable[[DriveCommand], DriveCommand]:
    """Put the parameters of `drive_from_options` in the place of a command's first.

    `node` names the drive; None where the command is for all that are on the bus or the line.
    """
    line = [
        each.replace(annotation=node) if each.name == "node" else each
        for each in signature(drive_from_options).parameters.values()
        if each.name != "node" or node is not None
    ]

    def with_options(command: DriveCommand) -> DriveCommand:
        _, *own = signature(command).parameters.values()

        @wraps(command)
        def called(**given: Any) -> None:
            drive = drive_from_options(**{each.name: given.pop(each.name) for each in line})
            command(drive, **given)

        arguments = [each for each in own if each.kind is not each.KEYWORD_ONLY]
        options = [each for each in own if each.kind is each.KEYWORD_ONLY]
        # What typer reads to learn a command's options.
        setattr(called, "__signature__", Signature([*arguments, *line, *options]))  # noqa: B010 - no such attribute in its type
        return called

    return with_options
