"""Process data between the bridge and one drive; the same for every robot.

A drive takes one set-point frame, sends its Statusword when it changes, and answers each SYNC with its
Statusword, position and current, all sampled at that SYNC. A drive whose position leads others sends it
between the SYNCs, too; one whose own stop keeps a ratio takes its quick stop deceleration. The other PDOs are
off.
"""

import struct
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.pdo import EVERY_SYNC, ON_CHANGE, Layout
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.robot import Axis, CommandForm

SET_POINT: Final = {
    CommandForm.SPEED: Layout(
        (od.CONTROLWORD, DataType.UNSIGNED16), (od.TARGET_VELOCITY, DataType.INTEGER32)
    ),
    CommandForm.POSITION: Layout(
        (od.CONTROLWORD, DataType.UNSIGNED16), (od.TARGET_POSITION, DataType.INTEGER32)
    ),
}
STATUS: Final = Layout((od.STATUSWORD, DataType.UNSIGNED16))
SAMPLE: Final = struct.Struct("<Hih")
"""Statusword, position and current."""
POSITION: Final = Layout((od.POSITION_ACTUAL, DataType.INTEGER32))
BRAKING: Final = Layout((od.QUICK_STOP_DECELERATION, DataType.UNSIGNED32))

SET_POINT_COB_ID: Final = {
    CommandForm.SPEED: cia301.RECEIVE_PDO[3],
    CommandForm.POSITION: cia301.RECEIVE_PDO[2],
}
"""Add the node's number."""
STATUS_COB_ID: Final = cia301.TRANSMIT_PDO[0]
SAMPLE_COB_ID: Final = cia301.TRANSMIT_PDO[1]
POSITION_COB_ID: Final = cia301.TRANSMIT_PDO[2]
BRAKING_COB_ID: Final = cia301.RECEIVE_PDO[0]
INHIBIT_MS: Final = 1
"""A chattering Statusword must not fill the bus."""


@dataclass(frozen=True, slots=True)
class Pdo:
    """One PDO of the drive: where its parameters live, and how it is used."""

    communication: int
    mapping: int
    cob_id: int
    """Without the node's number."""
    transmits: bool
    """From the drive's side."""
    layout: Layout | None
    """None: the PDO is off."""
    transmission: int = ON_CHANGE
    inhibit_ms: int = INHIBIT_MS
    """Least time between two frames that are sent on change."""

    def cob_id_entry(self, node: int, *, valid: bool) -> int:
        """Return the value of subindex 1 for this node: flags and identifier."""
        # Bit 30: no remote request; bit 31: the PDO is off (CiA 301).
        flags = cia301.COB_ID_NO_REMOTE if self.transmits else 0
        if not valid:
            flags |= cia301.COB_ID_INVALID
        return flags | (self.cob_id + node)


def sampled(current: Address) -> Layout:
    """Return the layout of `SAMPLE` for a drive whose current is this object."""
    return Layout(
        (od.STATUSWORD, DataType.UNSIGNED16),
        (od.POSITION_ACTUAL, DataType.INTEGER32),
        (current, DataType.INTEGER16),
    )


def pdos(axis: Axis, current: Address) -> tuple[Pdo, ...]:
    """Return the eight PDOs of an axis's drive, whose current is this object."""
    command, every_ms = axis.command, DriveAxis.of(axis).position_every_ms
    received = {SET_POINT_COB_ID[command]: SET_POINT[command]}
    if DriveAxis.of(axis).profile.quick_stop_least_rpm_s is not None:
        received[BRAKING_COB_ID] = BRAKING
    sent = {STATUS_COB_ID: STATUS, SAMPLE_COB_ID: sampled(current)}
    inhibited = {}
    if every_ms is not None:
        sent[POSITION_COB_ID] = POSITION
        inhibited[POSITION_COB_ID] = every_ms
    timing = {SAMPLE_COB_ID: EVERY_SYNC}
    return (
        *(
            Pdo(0x1400 + i, 0x1600 + i, cob_id, transmits=False, layout=received.get(cob_id))
            for i, cob_id in enumerate(cia301.RECEIVE_PDO)
        ),
        *(
            Pdo(
                0x1800 + i,
                0x1A00 + i,
                cob_id,
                transmits=True,
                layout=sent.get(cob_id),
                transmission=timing.get(cob_id, ON_CHANGE),
                inhibit_ms=inhibited.get(cob_id, INHIBIT_MS),
            )
            for i, cob_id in enumerate(cia301.TRANSMIT_PDO)
        ),
    )
