"""Places of a robot's links on this machine: one for each, from the options of a command."""

from collections.abc import Sequence
from dataclasses import dataclass

from firmware_bridge.cli.console import one_message, refusal
from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot.problems import near
from firmware_bridge.robot.table import Medium
from firmware_bridge.slow_link.conditions import Conditions, ConditionsError, conditions

SERIAL_WORD = "serial"


@dataclass(frozen=True, slots=True)
class BusAddress:
    """A CAN bus by interface and channel, or a serial device."""

    interface: str | None = None
    channel: str | None = None
    device: str | None = None

    @property
    def title(self) -> str:
        """The place as text."""
        return self.device or self.channel or "the configured bus"


def split_links(robot: AnyRobot, texts: Sequence[str] | None) -> tuple[list[str], Conditions | None]:
    """Split the texts into places and the conditions of the operator's link; None: as it is.

    An error in the latter ends the program.
    """
    # One option has both: a place has a colon, or a link's name before its sign.
    places = [text for text in texts or () if ":" in text or text.partition("=")[0] in robot.links]
    slow = [text for text in texts or () if text not in places]
    if not slow:
        return places, None
    with one_message(ConditionsError):
        return places, conditions(",".join(slow))


def places_of(robot: AnyRobot, texts: Sequence[str] | None, only: BusAddress) -> dict[str, BusAddress]:
    """Return the place of each link, `only` for a robot with one; an error ends the program.

    Capture systems are excluded: their places are in the robot file.
    """
    links = [name for name, link in robot.links.items() if link.medium is not Medium.UDP]
    if not texts:
        if len(links) > 1:
            raise refusal(
                f"{robot.name} has several links ({', '.join(links)}); use --link NAME=PLACE for each"
            )
        return dict.fromkeys(links, only)
    if only != BusAddress():
        raise refusal("--link names every place; leave out -i, -c and --serial")
    places = {}
    for text in texts:
        name, sign, place = text.partition("=")
        interface, colon, channel = place.partition(":")
        if not sign or not colon or not interface or not channel:
            raise refusal(f"--link {text}: give NAME=INTERFACE:CHANNEL or NAME=serial:DEVICE")
        if name not in links:
            raise refusal(f"--link {text}: {robot.name} has no link '{name}'; {near(name, links)}")
        serial = interface == SERIAL_WORD
        places[name] = BusAddress(device=channel) if serial else BusAddress(interface, channel)
    missing = [name for name in links if name not in places]
    if missing:
        raise refusal(f"{robot.name}: no place for {', '.join(missing)}; use --link {missing[0]}=PLACE, too")
    return places
