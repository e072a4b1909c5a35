"""Process data between the bridge and one EPOS2; the same for every robot.

A drive takes one set-point frame, sends its Statusword when it changes, and answers each SYNC with its
Statusword, position and current, all sampled at that SYNC. The other PDOs are off.
"""

from dataclasses import dataclass
from typing import Final

from firmware_bridge.robot import CommandForm
from firmware_bridge.wire import canopen
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.rows import DataType
from firmware_bridge.wire.pdo import Layout

SYNCHRONOUS: Final = 1
ON_CHANGE: Final = 255

SET_POINT: Final = {
    CommandForm.SPEED: Layout(
        (at.CONTROLWORD, DataType.UNSIGNED16), (at.TARGET_VELOCITY, DataType.INTEGER32)
    ),
    CommandForm.POSITION: Layout(
        (at.CONTROLWORD, DataType.UNSIGNED16), (at.TARGET_POSITION, DataType.INTEGER32)
    ),
}
STATUS: Final = Layout((at.STATUSWORD, DataType.UNSIGNED16))
SAMPLE: Final = Layout(
    (at.STATUSWORD, DataType.UNSIGNED16),
    (at.POSITION_ACTUAL, DataType.INTEGER32),
    (at.CURRENT_AVERAGED, DataType.INTEGER16),
)

SET_POINT_COB_ID: Final = {
    CommandForm.SPEED: canopen.RECEIVE_PDO[3],
    CommandForm.POSITION: canopen.RECEIVE_PDO[2],
}
"""Add the node's number."""
STATUS_COB_ID: Final = canopen.TRANSMIT_PDO[0]
SAMPLE_COB_ID: Final = canopen.TRANSMIT_PDO[1]


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

    def cob_id_entry(self, node: int, *, valid: bool) -> int:
        """Return the value of subindex 1 for this node: flags and identifier."""
        # Bit 30: no remote request; bit 31: the PDO is off (CiA 301).
        flags = canopen.COB_ID_NO_REMOTE if self.transmits else 0
        if not valid:
            flags |= canopen.COB_ID_INVALID
        return flags | (self.cob_id + node)


def pdos(command: CommandForm) -> tuple[Pdo, ...]:
    """Return the eight PDOs of a drive that is commanded like this."""
    received = {SET_POINT_COB_ID[command]: SET_POINT[command]}
    sent = {STATUS_COB_ID: STATUS, SAMPLE_COB_ID: SAMPLE}
    timing = {SAMPLE_COB_ID: SYNCHRONOUS}
    return (
        *(
            Pdo(0x1400 + i, 0x1600 + i, cob_id, transmits=False, layout=received.get(cob_id))
            for i, cob_id in enumerate(canopen.RECEIVE_PDO)
        ),
        *(
            Pdo(
                0x1800 + i,
                0x1A00 + i,
                cob_id,
                transmits=True,
                layout=sent.get(cob_id),
                transmission=timing.get(cob_id, ON_CHANGE),
            )
            for i, cob_id in enumerate(canopen.TRANSMIT_PDO)
        ),
    )
