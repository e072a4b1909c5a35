"""The EPOS2's profile position mode: a controlword that is written is a set-point, edge or not.

By SDO or a serial command, that is: maxon's command library writes 0x607A and then 0x3F or 0x7F for every
move, and never lowers bit 4. A PDO repeats its word with every cycle, so that there the edge counts (assumed:
what a device makes of repeated words in PDOs is not known, and each of them for a set-point would begin a
relative move again with every cycle). A target outside 0x607D is FF09.
"""

from typing import ClassVar

from emulators.drive.profile_position import ProfilePosition


class WrittenPosition(ProfilePosition):
    """Mode that moves to the position 0x607A."""

    goes_by_writes: ClassVar[bool] = True
