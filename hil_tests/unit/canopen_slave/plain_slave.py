"""A device without a maker: a few rows of a dictionary, the standard's choices; frames in and out by hand."""

from types import MappingProxyType
from typing import Final

from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import LayerSetting, Product
from emulators.canopen.saved_parameters import Volatile
from emulators.canopen.slave import CanopenSlave
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.data_type import Access, DataType
from firmware_bridge.canopen.emergency import Emergency, FaultReaction, RegisterBit
from firmware_bridge.canopen.object_dictionary import ObjectDictionary
from firmware_bridge.canopen.object_row import ObjectRow
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds

NODE: Final = 5
RO, RW = Access.RO, Access.RW
U8, U16, U32 = DataType.UNSIGNED8, DataType.UNSIGNED16, DataType.UNSIGNED32
NODE_NUMBER, BIT_RATE, BIT_RATE_IN_USE = Address(0x5000), Address(0x5001), Address(0x5002)


def row(
    index: int, sub: int, kind: DataType, access: Access, default: int = 0, *, mapped: bool = False
) -> ObjectRow:
    return ObjectRow(Address(index, sub), f"0x{index:04X}:{sub}", kind, access, mapped, default)


DICTIONARY: Final = ObjectDictionary(
    (
        row(0x1000, 0, U32, RO, 0x0002_0192),
        row(0x1001, 0, U8, RO),
        row(0x1003, 0, U8, RW),
        row(0x1005, 0, U32, RW, 0x80),
        *(row(0x1003, sub, U32, RO) for sub in (1, 2)),
        row(0x1010, 1, U32, RW),
        row(0x1011, 1, U32, RW),
        row(0x1012, 0, U32, RW, 0x8000_0100),
        row(0x1014, 0, U32, RW, 0x80 + NODE),
        row(0x1016, 0, U8, RO, 3),
        *(row(0x1016, sub, U32, RW) for sub in (1, 2, 3)),
        row(0x1017, 0, U16, RW),
        *(row(0x1018, sub, U32, RO, sub) for sub in (1, 2, 3, 4)),
        row(0x1400, 1, U32, RW, 0x200 + NODE),
        row(0x1400, 2, U8, RW, 255),
        row(0x1400, 5, U16, RW),
        row(0x1600, 0, U8, RW, 1),
        *(row(0x1600, sub, U32, RW, default) for sub, default in ((1, 0x6040_0010), (2, 0))),
        row(0x1800, 1, U32, RW, 0x4000_0180 + NODE),
        row(0x1800, 2, U8, RW, 255),
        row(0x1800, 3, U16, RW),
        row(0x1800, 5, U16, RW),
        row(0x1A00, 0, U8, RW, 1),
        *(row(0x1A00, sub, U32, RW, default) for sub, default in ((1, 0x6041_0010), (2, 0))),
        row(0x5000, 0, U8, RW, 1),
        row(0x5001, 0, U8, RW),
        row(0x5002, 0, U8, RO),
        row(0x6040, 0, U16, RW, mapped=True),
        row(0x6041, 0, U16, RO, 0x0040, mapped=True),
    )
)
PRODUCT: Final = Product(
    name="plain slave",
    layer_setting=LayerSetting(
        node_number=NODE_NUMBER,
        bit_rate=BIT_RATE,
        bit_rate_in_use=BIT_RATE_IN_USE,
        bit_rates=MappingProxyType({0: 1_000_000, 4: 125_000}),
    ),
    is_parameter=lambda it: it.access.writable and it.address.index not in {0x1003, 0x1010, 0x1011, 0x6040},
    emergencies=MappingProxyType(
        {
            code: Emergency(code, RegisterBit.COMMUNICATION, FaultReaction.NONE, title)
            for code, title in ((0x8210, "PDO too short"), (0x8250, "PDO not received in time"))
        }
    ),
)


class Quiet:
    """Application without a motor, which reports what the bus side finds."""

    hung = False

    def __init__(self) -> None:
        self.slave: CanopenSlave | None = None
        self.operational = False
        self.lost = 0

    def nmt_changed(self, operational: bool) -> None:  # noqa: FBT001 - as in the protocol
        self.operational = operational

    def connection_lost(self) -> None:
        self.lost += 1

    def communication_fault(self, code: int) -> None:
        assert self.slave is not None
        self.slave.report(code)

    def communication_reset(self) -> None:
        """Nothing stands here."""

    def refresh(self, now: Nanoseconds) -> None:
        """Nothing moves."""

    def wake_at(self) -> Nanoseconds:
        return NEVER

    def reset(self) -> None:
        """Nothing is kept."""


class PlainSlave:
    """The slave, and the time beside it. Frames are written `"605#2B17100064000000"`."""

    def __init__(self, hardware_node: int = NODE) -> None:
        self.application = Quiet()
        self.now: Nanoseconds = 0
        self.store = ObjectStore(DICTIONARY, hardware_node or 1)
        self.slave = CanopenSlave(
            hardware_node, self.store, PRODUCT, self.application, storage=Volatile(), bus_rate=1_000_000
        )
        self.application.slave = self.slave

    def wakes(self, now: Nanoseconds) -> list[str]:
        self.now = now
        return written(self.slave.wake(now))

    def takes(self, frame: str) -> list[str]:
        head, _, tail = frame.partition("#")
        return written(self.slave.receive(Packet(CAN, int(head, 16), bytes.fromhex(tail)), self.now))


def written(reaction: Reaction) -> list[str]:
    """Return the frames of a reaction as text."""
    return [f"{it.address:03X}#{it.payload.hex().upper()}" for it in reaction.sent]
