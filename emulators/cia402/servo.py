"""One emulated servo on a CAN bus: a CANopen slave with a drive of CiA 402 behind it."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import Final

from emulators.canopen.identity import FIRST_NUMBER
from emulators.canopen.product import LayerSetting, Product
from emulators.canopen.saved_parameters import Storage, Volatile
from emulators.canopen.slave import CanopenSlave
from emulators.cia402.errors import EMERGENCIES
from emulators.cia402.motion_control import MotionControl
from emulators.cia402.servo_objects import ServoObjects
from emulators.cia402.variations import PLAIN, Traits
from emulators.servo.axis import ServoAxis
from emulators.servo.scaling import Settings
from firmware_bridge.canopen.abort import AbortCode, SdoAbort
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import COB_ID_NO_REMOTE, LAST_NODE
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.canopen.pdo import TRANSMIT_PARAMETER
from firmware_bridge.families.cia402.wire import address as at
from firmware_bridge.families.cia402.wire.objects import PDOS, objects_of

BIT_RATES: Final[Mapping[int, int]] = MappingProxyType(
    {0: 1_000_000, 1: 800_000, 2: 500_000, 3: 250_000, 4: 125_000, 6: 50_000, 7: 20_000, 8: 10_000}
)
"""Bits a second by code (CiA 305); code 5 is reserved."""
_NOT_SAVED: Final = frozenset(
    {0x1003, 0x1010, 0x1011, 0x6040, 0x6060, 0x6071, 0x607A, 0x60B0, 0x60B1, 0x60B2, 0x60FE, 0x60FF}
)
"""Commands and set-points: a restart must not bring them back."""


def _is_parameter(row: ObjectRow) -> bool:
    return row.access.writable and row.address.index not in _NOT_SAVED


PRODUCT: Final = Product(
    name="CiA 402 servo",
    layer_setting=LayerSetting(
        node_number=at.NODE_NUMBER,
        bit_rate=at.BIT_RATE,
        bit_rate_in_use=at.BIT_RATE_IN_USE,
        bit_rates=BIT_RATES,
    ),
    is_parameter=_is_parameter,
    emergencies=EMERGENCIES,
)


def _has_no_remote(cob_id: int) -> None:
    if not cob_id & COB_ID_NO_REMOTE:
        raise SdoAbort(AbortCode.RANGE)


class Servo(CanopenSlave):
    """One servo. `node_id` is the setting of its switch; with 0 the saved number counts."""

    def __init__(
        self,
        node_id: int,
        axis: ServoAxis,
        traits: Traits = PLAIN,
        *,
        settings: Settings | None = None,
        commissioned: Mapping[Address, int] = MappingProxyType({}),
        storage: Storage | None = None,
        bus_rate: int | None = None,
    ) -> None:
        """Take the settings and objects of its maker's tool; without them it has its own.

        `storage` keeps saved parameters; at another bit rate than `bus_rate` it is off the bus.
        """
        if not 0 <= node_id <= LAST_NODE:
            raise ValueError(f"a switch gives a number between 0 and {LAST_NODE}, not {node_id}")
        self._number: Final = node_id
        self._axis: Final = axis
        self._settings: Final = settings
        self._commissioned: Final = commissioned
        self._storage: Final = storage or Volatile()
        self._rate: Final = bus_rate
        self.become(traits)

    def become(self, traits: Traits) -> None:
        """Put a servo with these traits in the place of this one, with the same motor and parameters.

        It is without power, and starts with the next packet.
        """
        rates = {rate: code for code, rate in BIT_RATES.items()}
        own_rate = {} if self._rate is None else {at.BIT_RATE: rates[self._rate]}
        store = ServoObjects(
            objects_of(self._axis.encoder_resolution, traits.absent),
            self._number or FIRST_NUMBER,
            {**self._commissioned, **own_rate},
        )
        self.motion = MotionControl(store, self._axis, self.report, traits, self._settings)
        if traits.keeps_no_remote:
            for place in range(PDOS):
                store.on_write(Address(TRANSMIT_PARAMETER + place, 1), _has_no_remote)
        product = replace(PRODUCT, boot_time=traits.boot_time, transmit_types=traits.transmit_types)
        super().__init__(
            self._number, store, product, self.motion, storage=self._storage, bus_rate=self._rate
        )
