"""Difficult but lawful drives: what servos in the field do otherwise than most masters expect, by name.

Each row is what a maker's drive was seen to do, and where. Several may be put on one servo.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, fields, replace
from types import MappingProxyType
from typing import Final

from firmware_bridge.canopen.pdo import EVENT_DRIVEN, ON_REQUEST, TRANSMIT_TYPES
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds


class VariationError(ValueError):
    """No variation has this name."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Traits:
    """What may vary; the defaults are the plain servo's."""

    boot_time: Nanoseconds = 0
    """From power-on or a reset to the boot-up message."""
    absent: frozenset[int] = frozenset()
    """Indexes of objects that it has not got."""
    transmit_types: frozenset[int] = TRANSMIT_TYPES
    """Transmission types of its transmit PDOs."""
    keeps_no_remote: bool = False
    """A transmit PDO's COB-ID is refused without bit 30."""
    remote_when_operational: bool = False
    """Statusword bit 9 is 0 outside Operational."""
    controlword_gap: Nanoseconds = 0
    """A controlword that comes sooner after the one before is not seen."""
    period_first: bool = False
    """It is not enabled before 0x60C2:1 was written."""
    mode_first: bool = False
    """It is not enabled in mode 0."""
    mode_not_halted: bool = False
    """A mode that is written while bit 8 of the controlword is 1 is not taken."""
    mode_without_power: bool = False
    """A mode that is written in Operation enabled is not taken."""
    mode_takes: Nanoseconds = 0
    """0x6061 shows -1 for so long after a mode was written."""
    resumes: bool = False
    """Enable operation leads out of Quick stop active whatever 0x605A holds, and the state lasts."""
    acknowledged_when_enabled: bool = False
    """Bit 12 is 1 after enabling until bit 4 of the controlword changes."""
    offset_added: bool = False
    """At home 0x6064 is 0x607C, not its negative."""
    no_method_0: bool = False
    """0x6098 refuses 0."""

    def with_(self, *, offset_added: bool) -> "Traits":
        """Return these traits, and 0x607C read this way."""
        return replace(self, offset_added=offset_added)


PLAIN: Final = Traits()


@dataclass(frozen=True, slots=True)
class Variation:
    """One row: the traits that differ, in words, and where they were seen."""

    text: str
    seen: str
    traits: Traits
    bridge: str = "drives"
    """What the bridge does with such a drive."""


UNCONFIRMED: Final = "drives; an axis whose position must be confirmed or homed is not armed"
VARIATIONS: Final[Mapping[str, Variation]] = MappingProxyType(
    {
        "late-boot-up": Variation(
            "Its boot-up message comes 1.5 s after a reset.",
            "Ingenia, ros2_canopen issue 36: the driver waits 1 s by default",
            Traits(boot_time=1_500 * MILLISECOND),
        ),
        "period-first": Variation(
            "It is not enabled before 0x60C2:1 was written.",
            "Delta ASDA, hal-cia402 issue 3; EPOS4, ros2_canopen issue 405",
            Traits(period_first=True),
        ),
        "mode-first": Variation(
            "It is not enabled in mode 0.",
            "Nanotec PD4-C, ros_canopen pull request 331; Schunk, ros_canopen pull request 112",
            Traits(mode_first=True),
        ),
        "remote-when-operational": Variation(
            "Bit 9 of the statusword is 0 until the node is Operational.",
            "maxon EPOS2, recorded",
            Traits(remote_when_operational=True),
        ),
        "no-mode-while-halted": Variation(
            "A mode that is written while halt is 1 is not taken: 0x6061 stays as it is.",
            "Engel HBI3760, ros2_canopen issue 234: that master halts while it changes the mode",
            Traits(mode_not_halted=True),
            UNCONFIRMED,
        ),
        "mode-without-power": Variation(
            "A mode that is written in Operation enabled is not taken: 0x6061 stays as it is.",
            "Schunk and Elmo, ipa_canopen pull request 29; SOEM issue 510",
            Traits(mode_without_power=True),
            UNCONFIRMED,
        ),
        "mode-synchronizes": Variation(
            "0x6061 shows -1 for 5 s after a mode was written.",
            "Festo CMMP-AS, ros_canopen issue 457: masters wait 5 s",
            Traits(mode_takes=5 * SECOND),
        ),
        "resumes-after-quick-stop": Variation(
            "0x000F leads from Quick stop active to Operation enabled although 0x605A is 2.",
            "Elmo Platinum, jsd pull request 93",
            Traits(resumes=True),
        ),
        "slow-controlword": Variation(
            "A controlword less than 1 ms after the one before is not seen.",
            "Technosoft iPOS, yarp-devices issue 215",
            Traits(controlword_gap=MILLISECOND),
        ),
        "no-supported-modes": Variation(
            "There is no 0x6502.",
            "ros2_canopen issue 268; Faulhaber MCBL 3150 (its EDS)",
            Traits(absent=frozenset({0x6502})),
        ),
        "no-option-codes": Variation(
            "There are no 0x605A to 0x605E: a quick stop lasts, with power.",
            "Faulhaber MCBL 3150 (its EDS); maxon EPOS2 has no 0x605A and 0x605D",
            Traits(absent=frozenset({0x605A, 0x605B, 0x605C, 0x605D, 0x605E})),
        ),
        "statusword-by-event": Variation(
            "Its transmit PDOs are sent on events and requests only, never with SYNC.",
            "assumed, of drives with fixed PDOs; canopen's profile then goes by the last one that came",
            Traits(transmit_types=frozenset({*EVENT_DRIVEN, ON_REQUEST})),
            "refuses to start: it samples its drives by SYNC",
        ),
        "keeps-no-remote": Variation(
            "The COB-ID of a transmit PDO is refused without bit 30.",
            "Roboteq FBL2360T, canopen pull request 228",
            Traits(keeps_no_remote=True),
        ),
        "acknowledged-when-enabled": Variation(
            "Bit 12 of the statusword is 1 after enabling, until bit 4 of the controlword changes.",
            "canopen issue 678",
            Traits(acknowledged_when_enabled=True),
        ),
        "offset-added": Variation(
            "At home 0x6064 is 0x607C, not its negative.",
            "KEB's manual; canopen issue 246",
            Traits(offset_added=True),
            'drives with home = "itself" in the robot file; without it the axis is not armed',
        ),
        "no-method-0": Variation(
            "0x6098 refuses 0, with 0x06090030.",
            "maxon EPOS4, ros2_canopen issue 236 and 245",
            Traits(no_method_0=True),
        ),
    }
)


def traits_of(names: Iterable[str]) -> Traits:
    """Return the traits of a servo with these variations; VariationError for a name that none has."""
    found = PLAIN
    for name in names:
        variation = VARIATIONS.get(name)
        if variation is None:
            raise VariationError(f"{name}: no such variation; there are {', '.join(sorted(VARIATIONS))}")
        found = _joined(found, variation.traits)
    return found


def _joined(one: Traits, other: Traits) -> Traits:
    """Return the traits of one, with those in which the other differs from the plain servo."""
    names = (field.name for field in fields(Traits))
    differing = {name: getattr(other, name) for name in names if getattr(other, name) != getattr(PLAIN, name)}
    return replace(one, **differing | {"absent": one.absent | other.absent})
