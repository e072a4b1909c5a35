"""A device from its EDS: the dictionary that it describes, on the general slave; as a drive, where it is one.

A drive's motion is that of the plain servo, over the objects that the EDS has; those that it has not are
there for the servo alone, with the servo's values. A limit or a ramp whose default is 0 in the EDS has the
servo's, too (assumed): such a file names what may be set, and the drive comes from its maker with more.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from emulators.canopen.product import LayerSetting, Product
from emulators.canopen.saved_parameters import Storage, Volatile
from emulators.canopen.slave import CanopenSlave
from emulators.cia402.errors import EMERGENCIES
from emulators.cia402.motion_control import MotionControl
from emulators.cia402.servo import BIT_RATES
from emulators.cia402.servo_objects import ServoObjects
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.families.cia402.wire.objects import objects_of
from firmware_bridge.units import NEVER, Nanoseconds

if TYPE_CHECKING:
    from emulators.canopen.application import Application

DEVICE: Final = LayerSetting(
    node_number=Address(0x0F01),
    bit_rate=Address(0x0F02),
    bit_rate_in_use=Address(0x0F03),
    bit_rates=BIT_RATES,
)
"""Below all objects of a dictionary: the EDS does not name where a device keeps them."""
PRODUCT_NAME: Final = "device by its EDS"
NEVER_ZERO: Final = frozenset(
    {0x6072, 0x6073, 0x6075, 0x6076, 0x607F, 0x6080, 0x6081, 0x6083, 0x6084, 0x6085, 0x608F, 0x6091, 0x6092}
    | {0x6099, 0x609A, 0x60C5}
)
"""Limits, ratings and ramps with which 0 no motor would turn."""
NOT_SAVED: Final = frozenset({0x1003, 0x1010, 0x1011, 0x6040, 0x6060, 0x6071, 0x607A, 0x60FF})


class Nothing:
    """The application of a device that is no drive: its values are what was written."""

    hung = False

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - as in the protocol
        """Do nothing."""

    def connection_lost(self) -> None:
        """Do nothing."""

    def communication_fault(self, code: int) -> None:
        """Do nothing."""

    def communication_reset(self) -> None:
        """Do nothing."""

    def refresh(self, now: Nanoseconds) -> None:
        """Do nothing."""

    def wake_at(self) -> Nanoseconds:
        """Return that nothing is due."""
        return NEVER

    def reset(self) -> None:
        """Do nothing."""


def is_drive(rows: Sequence[ObjectRow]) -> bool:
    """Return whether the rows have a Controlword and a Statusword."""
    return {od.CONTROLWORD, od.STATUSWORD} <= {row.address for row in rows}


def _is_parameter(row: ObjectRow) -> bool:
    return row.access.writable and row.address.index not in NOT_SAVED


class DeviceOfEds(CanopenSlave):
    """One device; its node number is that of its switch."""

    def __init__(
        self,
        node_id: int,
        rows: Sequence[ObjectRow],
        axis: ServoAxis,
        *,
        storage: Storage | None = None,
        bus_rate: int | None = None,
    ) -> None:
        """Take its objects; `axis` is the motor of a drive, `storage` keeps saved parameters."""
        servo = objects_of(axis.encoder_resolution)
        codes = {rate: code for code, rate in BIT_RATES.items()}
        layer = [
            ObjectRow(address, "", DataType.UNSIGNED8, Access.RW, default=default)
            for address, default in (
                (DEVICE.node_number, node_id),
                (DEVICE.bit_rate, 0 if bus_rate is None else codes[bus_rate]),
                (DEVICE.bit_rate_in_use, 0),
            )
        ]
        known = ObjectDictionary(rows)
        better = {
            address: row.default
            for address, row in servo.items()
            if address.index in NEVER_ZERO and address in known and not known[address].default
        }
        store = ServoObjects(known, node_id, better, hidden=(*layer, *servo.values()))
        motion: Application = MotionControl(store, axis, self.report) if is_drive(rows) else Nothing()
        product = Product(
            name=PRODUCT_NAME,
            layer_setting=DEVICE,
            is_parameter=_is_parameter,
            emergencies=EMERGENCIES,
        )
        super().__init__(node_id, store, product, motion, storage=storage or Volatile(), bus_rate=bus_rate)
