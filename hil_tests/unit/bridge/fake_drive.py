"""A drive by the EPOS2's documents."""

from typing import TYPE_CHECKING

from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen import sdo
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.canopen.cia402 import ControlwordBit, ControlwordCommand, PowerState, command_of
from firmware_bridge.families.epos2.settings import Epos2Axis
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import Axis
from firmware_bridge.robot import CommandForm as Commanded
from firmware_bridge.units import SECOND, Nanoseconds

if TYPE_CHECKING:
    from firmware_bridge.canopen.address import Address

REMOTE = 1 << 9
ATTAINED = 1 << 12
REFERENCED = 1 << 15
HOMING = b"\x06"
ACTUAL_POSITION = b"\x23"
STEPS = {
    (PowerState.SWITCH_ON_DISABLED, ControlwordCommand.SHUTDOWN): PowerState.READY_TO_SWITCH_ON,
    (PowerState.READY_TO_SWITCH_ON, ControlwordCommand.DISABLE_OPERATION): PowerState.SWITCHED_ON,
    (PowerState.READY_TO_SWITCH_ON, ControlwordCommand.ENABLE_OPERATION): PowerState.OPERATION_ENABLED,
    (PowerState.SWITCHED_ON, ControlwordCommand.ENABLE_OPERATION): PowerState.OPERATION_ENABLED,
    (PowerState.OPERATION_ENABLED, ControlwordCommand.SHUTDOWN): PowerState.READY_TO_SWITCH_ON,
    (PowerState.OPERATION_ENABLED, ControlwordCommand.DISABLE_VOLTAGE): PowerState.SWITCH_ON_DISABLED,
    (PowerState.OPERATION_ENABLED, ControlwordCommand.QUICK_STOP): PowerState.QUICK_STOP_ACTIVE,
    (PowerState.QUICK_STOP_ACTIVE, ControlwordCommand.ENABLE_OPERATION): PowerState.OPERATION_ENABLED,
    (PowerState.QUICK_STOP_ACTIVE, ControlwordCommand.DISABLE_VOLTAGE): PowerState.SWITCH_ON_DISABLED,
    (PowerState.READY_TO_SWITCH_ON, ControlwordCommand.DISABLE_VOLTAGE): PowerState.SWITCH_ON_DISABLED,
    (PowerState.READY_TO_SWITCH_ON, ControlwordCommand.QUICK_STOP): PowerState.SWITCH_ON_DISABLED,
}


class FakeDrive:
    """SDO, NMT, states and PDOs by the EPOS2's documents, in few lines; it obeys at once.

    Written apart from the emulator: the bridge must agree with the documents, not with our other half.
    """

    def __init__(self, axis: Axis) -> None:
        self.axis = axis
        self.memory: dict[Address, bytes] = {
            od.DEVICE_TYPE: bytes.fromhex("92010200"),
            od.VENDOR_ID: bytes.fromhex("FB000000"),
            od.PRODUCT_CODE: bytes.fromhex("00002064"),
            at.VELOCITY_AVERAGED: bytes(4),
            at.ANALOGUE_INPUT_1: (4100).to_bytes(2, "little"),
        }
        self.written: list[tuple[Address, bytes]] = []
        self.refuses: dict[Address, AbortCode] = {}
        self.forgets: set[Address] = set()
        self.state = PowerState.SWITCH_ON_DISABLED
        self.nmt = NmtState.PRE_OPERATIONAL
        self.silent = False
        self.stuck_in: set[PowerState] = set()
        self.jammed = False
        self.words: list[tuple[Nanoseconds, int, int]] = []
        """Each set-point: when, controlword, target."""
        self.rpm = 0
        self.position = 0.0
        self.referenced = True
        """Its zero was set before, and it had power since."""
        self.attained = False
        self._word = 0
        self._moved_at: Nanoseconds = 0

    def wake(self, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        sent = [] if self.silent else self._received(packet, now)
        return Reaction(tuple(Packet(CAN, address, payload) for address, payload in sent))

    def fails(self, code: int) -> list[Packet]:
        """Go to fault; return what the drive then sends."""
        self.state = PowerState.FAULT
        self.rpm = 0
        node = Epos2Axis.of(self.axis).node
        emergency = code.to_bytes(2, "little") + bytes(6)
        return [Packet(CAN, 0x080 + node, emergency), Packet(CAN, 0x180 + node, self._status())]

    def boots(self) -> list[Packet]:
        """Lose everything; return what the drive then sends."""
        fresh = FakeDrive(self.axis)
        self.memory, self.state, self.nmt = fresh.memory, fresh.state, fresh.nmt
        self.rpm, self.position, self._word = 0, 0.0, 0
        self.referenced = self.attained = False
        return [Packet(CAN, 0x700 + Epos2Axis.of(self.axis).node, b"\0")]

    def _received(self, packet: Packet, now: Nanoseconds) -> list[tuple[int, bytes]]:
        node = Epos2Axis.of(self.axis).node
        if packet.address == 0x000 and packet.payload[1] in (0, node):
            self.nmt = {
                NmtCommand.START: NmtState.OPERATIONAL,
                NmtCommand.ENTER_PRE_OPERATIONAL: NmtState.PRE_OPERATIONAL,
            }[NmtCommand(packet.payload[0])]
            return [(0x180 + node, self._status())] if self.nmt is NmtState.OPERATIONAL else []
        if packet.address == 0x600 + node:
            return self._served(packet.payload)
        if self.nmt is not NmtState.OPERATIONAL:
            return []
        if packet.address == 0x080:
            self._move(now)
            return [(0x280 + node, self._status() + self._counter() + bytes((7, 0)))]
        if packet.address == (0x500 if self.axis.command is Commanded.SPEED else 0x400) + node:
            return self._commanded(packet.payload, now)
        return []

    def _served(self, payload: bytes) -> list[tuple[int, bytes]]:
        answer = None
        match sdo.decode_request(payload):
            case sdo.UploadRequest(address) if address in self.refuses:
                answer = sdo.encode_abort(address, self.refuses[address])
            case sdo.UploadRequest(address):
                now = {od.STATUSWORD: self._status(), od.POSITION_ACTUAL: self._counter()}
                raw = now.get(address) or self.memory.get(address)
                if raw is None:
                    answer = sdo.encode_abort(address, AbortCode.NO_OBJECT)
                else:
                    answer = sdo.encode_upload_response(address, raw)
            case sdo.DownloadRequest(address, raw, _) if raw is not None:
                if address in self.refuses:
                    answer = sdo.encode_abort(address, self.refuses[address])
                else:
                    self.written.append((address, raw))
                    self.memory[address] = bytes(len(raw)) if address in self.forgets else raw
                    if address == od.MODE:
                        self.memory[od.MODE_DISPLAY] = self.memory[od.MODE]
                    if address == od.CONTROLWORD:
                        self._obey(int.from_bytes(raw, "little"))
                    answer = sdo.encode_download_response(address)
        return [] if answer is None else [(0x580 + Epos2Axis.of(self.axis).node, answer)]

    def _commanded(self, payload: bytes, now: Nanoseconds) -> list[tuple[int, bytes]]:
        word = int.from_bytes(payload[:2], "little")
        target = int.from_bytes(payload[2:6], "little", signed=True)
        self.words.append((now, word, target))
        before, edge = self.state, word & ~self._word & ControlwordBit.NEW_SETPOINT and not self._homes
        self._move(now)
        self._obey(word)
        moves = self.state is PowerState.OPERATION_ENABLED
        if self.axis.command is Commanded.SPEED:
            self.rpm = target if moves else 0
        elif moves and edge and not self.jammed:
            self.position = float(target)
        return [(0x180 + Epos2Axis.of(self.axis).node, self._status())] if self.state is not before else []

    def _obey(self, word: int) -> None:
        reset = word & ~self._word & ControlwordBit.FAULT_RESET
        edge = word & ~self._word & ControlwordBit.NEW_SETPOINT
        self._word = word
        if edge and self._homes and self.state is PowerState.OPERATION_ENABLED:
            assert self.memory[od.HOMING_METHOD] == ACTUAL_POSITION, "by another method it would move"
            self.position = float(int.from_bytes(self.memory[at.HOME_POSITION], "little", signed=True))
            self.referenced = self.attained = True
        if self.state in self.stuck_in:
            return
        if self.state is PowerState.FAULT and reset:
            self.state = PowerState.SWITCH_ON_DISABLED
        self.state = STEPS.get((self.state, command_of(word)), self.state)

    def _move(self, now: Nanoseconds) -> None:
        turns = self.rpm / 60.0 * (now - self._moved_at) / SECOND
        self.position += turns * Epos2Axis.of(self.axis).counts_per_turn
        self._moved_at = now

    def _counter(self) -> bytes:
        return (round(self.position) & 0xFFFF_FFFF).to_bytes(4, "little")

    def _status(self) -> bytes:
        remote = REMOTE if self.nmt is NmtState.OPERATIONAL else 0
        known = REFERENCED if self.referenced else 0
        attained = ATTAINED if self.attained and self._homes else 0
        return (STATUSWORDS[self.state] | remote | known | attained).to_bytes(2, "little")

    @property
    def _homes(self) -> bool:
        return self.memory.get(od.MODE) == HOMING
