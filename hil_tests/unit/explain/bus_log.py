"""A recording written frame by frame: a master's requests as python-canopen sends them, a drive's answers."""

from pathlib import Path
from typing import Self

from firmware_bridge.canopen import cia301, sdo
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.recording import EPOCH
from firmware_bridge.units import MILLISECOND, SECOND, Nanoseconds

CONTROLWORD, STATUSWORD = Address(0x6040), Address(0x6041)
MODE, MODE_DISPLAY = Address(0x6060), Address(0x6061)
POSITION, VELOCITY = Address(0x6064), Address(0x606C)
TARGET_POSITION, TARGET_VELOCITY = Address(0x607A), Address(0x60FF)
OFF, READY, ON, ENABLED, FAULT, STOPPED = 0x0740, 0x0721, 0x0723, 0x0737, 0x0708, 0x0717
"""Statuswords of a drive that is operational."""
SIZES = {
    **dict.fromkeys((0x6040, 0x6041, 0x1017), 2),
    **dict.fromkeys((0x6060, 0x6061), 1),
}
"""Of objects, in bytes; 4 for the others, 1 for sub-indexes 0 and 2 of PDOs."""


class BusLog:
    """Frames with their instants, one every millisecond."""

    def __init__(self, node: int = 1) -> None:
        self.node = node
        self.at: Nanoseconds = 0
        self.lines: list[str] = []

    def frame(self, address: int, payload: bytes | str = b"") -> Self:
        data = bytes.fromhex(payload) if isinstance(payload, str) else payload
        seconds, rest = divmod(self.at + EPOCH, SECOND)
        digits = 8 if address > 0x7FF else 3
        self.lines.append(f"({seconds}.{rest // 1000:06d}) can0 {address:0{digits}X}#{data.hex().upper()}")
        self.at += MILLISECOND
        return self

    def wait(self, seconds: float) -> Self:
        self.at += round(seconds * SECOND)
        return self

    def boot(self) -> Self:
        return self.frame(cia301.ERROR_CONTROL + self.node, b"\0")

    def beat(self, state: NmtState = NmtState.OPERATIONAL, node: int | None = None) -> Self:
        return self.frame(cia301.ERROR_CONTROL + (self.node if node is None else node), bytes((state,)))

    def beats(self, count: int, every: float = 0.1, state: NmtState = NmtState.OPERATIONAL) -> Self:
        for _ in range(count):
            self.beat(state).wait(every - 0.001)
        return self

    def nmt(self, command: NmtCommand, node: int | None = None) -> Self:
        return self.frame(cia301.NMT, cia301.encode_nmt(command, self.node if node is None else node))

    def started(self) -> Self:
        """Boot-up, NMT start, and the answer to a first request."""
        return self.boot().nmt(NmtCommand.START).shows(STATUSWORD, OFF)

    def request(self, address: Address, value: int) -> Self:
        return self.frame(
            cia301.SDO_REQUEST + self.node, sdo.encode_download(address, encoded(address, value))
        )

    def write(self, address: Address, value: int) -> Self:
        self.request(address, value)
        return self.frame(cia301.SDO_RESPONSE + self.node, sdo.encode_download_response(address))

    def refused(self, address: Address, value: int, code: int) -> Self:
        self.request(address, value)
        return self.frame(cia301.SDO_RESPONSE + self.node, sdo.encode_abort(address, code))

    def shows(self, address: Address, value: int) -> Self:
        """An object that the master reads."""
        self.frame(cia301.SDO_REQUEST + self.node, sdo.encode_upload(address))
        answer = sdo.encode_upload_response(address, encoded(address, value))
        return self.frame(cia301.SDO_RESPONSE + self.node, answer)

    def status(self, value: int) -> Self:
        """The statusword by the first transmit PDO."""
        return self.frame(cia301.TRANSMIT_PDO[0] + self.node, encoded(STATUSWORD, value))

    def enabled(self) -> Self:
        """The three steps to operation enabled, each with the state after it."""
        for word, status in ((0x06, READY), (0x07, ON), (0x0F, ENABLED)):
            self.write(CONTROLWORD, word).shows(STATUSWORD, status)
        return self

    def stands(self, seconds: float = 3.0) -> Self:
        """The drive is read again and again, and stands where it is."""
        for _ in range(round(seconds / 0.1)):
            self.shows(POSITION, 0).wait(0.098)
        return self

    def map_rpdo(self, number: int, cob_id: int, transmission: int, *objects: int) -> Self:
        """Set up a receive PDO as python-canopen does: off, mapping, on."""
        parameter, mapping = 0x1400 + number - 1, 0x1600 + number - 1
        self.write(Address(parameter, 1), cob_id | cia301.COB_ID_INVALID)
        self.write(Address(parameter, 2), transmission).write(Address(mapping, 0), 0)
        for place, entry in enumerate(objects, start=1):
            self.write(Address(mapping, place), entry)
        return self.write(Address(mapping, 0), len(objects)).write(Address(parameter, 1), cob_id)

    def save(self, path: Path) -> Path:
        path.write_text("".join(f"{line}\n" for line in self.lines))
        return path


def encoded(address: Address, value: int) -> bytes:
    size = SIZES.get(address.index, 4)
    if address.index in range(0x1400, 0x1C00) and (address.subindex == 0 or _is_type(address)):
        size = 1
    return (value & ((1 << 8 * size) - 1)).to_bytes(size, "little")


def _is_type(address: Address) -> bool:
    return not address.index & 0x200 and address.subindex == 2
