"""Move one drive to a position over its USB port, in maxon's serial protocol V2.

Usage: python usb_v2.py PORT NODE COUNTS

Nothing but pyserial is needed. A frame, as maxon's EPOS2 Application Notes Collection has it, is DLE STX,
opcode, number of words, words, check sum; each DLE after STX is sent twice. The drive on the port reaches the
others on its CAN bus. Exit status 0: it is there; 1: something went wrong, and what.
"""

import sys
import time

import serial

DLE, STX = 0x90, 0x02
READ, WRITE = 0x10, 0x11
ANSWER = 0x00
RATE = 1_000_000
ANSWERS_S = 10.0
ENABLES_S = 10.0
MOVES_S = 60.0
CONTROLWORD, STATUSWORD, MODE, POSITION, TARGET = 0x6040, 0x6041, 0x6060, 0x6064, 0x607A
WINDOW, WINDOW_TIME = 0x6067, 0x6068
PROFILE_POSITION = 1
NEAR = 20
STAYS_MS = 200
ENABLED, STATE, FAULT, REACHED = 0x27, 0x6F, 0x08, 0x400


class DriveError(Exception):
    """A request that the drive, or the line, did not fulfil."""


def check_sum(data: bytes) -> int:
    """CRC-CCITT over 16-bit words, the high byte first, begun with 0 and ended with a word of 0."""
    crc = 0
    for place in range(0, len(data), 2):
        word = data[place] | data[place + 1] << 8
        for bit in range(15, -1, -1):
            carry = crc & 0x8000
            crc = crc << 1 & 0xFFFF | word >> bit & 1
            if carry:
                crc ^= 0x1021
    return crc


class Drive:
    """One node behind a port."""

    def __init__(self, port: str, node: int) -> None:
        self.line = serial.Serial(port, RATE, timeout=ANSWERS_S)
        self.node = node

    def reads(self, index: int) -> bytes:
        """Return an object of subindex 0 as four bytes."""
        return self.request(READ, bytes([index & 0xFF, index >> 8, 0, self.node]))[:4]

    def writes(self, index: int, value: int) -> None:
        """Write an object of subindex 0."""
        head = bytes([index & 0xFF, index >> 8, 0, self.node])
        self.request(WRITE, head + (value & 0xFFFFFFFF).to_bytes(4, "little"))

    def request(self, opcode: int, data: bytes) -> bytes:
        """Send a command, and return what follows the error code of its answer."""
        body = bytes([opcode, len(data) // 2]) + data
        body += check_sum(body + bytes(2)).to_bytes(2, "little")
        self.line.write(bytes([DLE, STX]) + body.replace(bytes([DLE]), bytes([DLE, DLE])))
        answered = self.answer()
        error = int.from_bytes(answered[:4], "little")
        if error:
            raise DriveError(f"node {self.node} answers with error 0x{error:08X}")
        return answered[4:]

    def answer(self) -> bytes:
        """Return the data of the next frame."""
        if self.line.read(2) != bytes([DLE, STX]):
            raise DriveError("no answer")
        head = self.takes(2)
        rest = self.takes(2 * head[1] + 2)
        if check_sum(head + rest[:-2] + bytes(2)) != int.from_bytes(rest[-2:], "little"):
            raise DriveError("an answer with a wrong check sum")
        if head[0] != ANSWER:
            raise DriveError(f"an answer of opcode 0x{head[0]:02X}")
        return rest[:-2]

    def takes(self, count: int) -> bytes:
        """Return so many bytes, a DLE once that came twice."""
        taken = b""
        while len(taken) < count:
            byte = self.line.read(1)
            if byte == bytes([DLE]):
                byte = self.line.read(1)
            if not byte:
                raise DriveError("an answer that is cut off")
            taken += byte
        return taken

    def status(self) -> int:
        """Return the statusword of a drive that has no fault."""
        word = int.from_bytes(self.reads(STATUSWORD)[:2], "little")
        if word & FAULT:
            raise DriveError(f"node {self.node} has a fault, statusword 0x{word:04X}")
        return word

    def becomes(self, mask: int, wanted: int, what: str, within: float) -> None:
        """Wait so many seconds for bits of the statusword."""
        until = time.monotonic() + within
        while self.status() & mask != wanted:
            if time.monotonic() > until:
                raise DriveError(f"node {self.node} is not {what} in time")


def main(port: str, node: int, counts: int) -> None:
    """Enable it, move it, and take its power off again."""
    drive = Drive(port, node)
    drive.status()
    drive.writes(MODE, PROFILE_POSITION)
    drive.writes(WINDOW, NEAR)  # without it the end of the profile counts, not where the shaft is
    drive.writes(WINDOW_TIME, STAYS_MS)  # without it a shaft that runs through is there, too
    drive.writes(CONTROLWORD, 0x06)
    drive.writes(CONTROLWORD, 0x0F)
    drive.becomes(STATE, ENABLED, "enabled", ENABLES_S)
    drive.writes(TARGET, counts)
    drive.writes(CONTROLWORD, 0x3F)
    drive.becomes(REACHED, REACHED, "there", MOVES_S)
    print(f"node {node}: at {int.from_bytes(drive.reads(POSITION), 'little', signed=True)}")
    drive.writes(CONTROLWORD, 0x06)


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    try:
        main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
    except DriveError as error:
        sys.exit(str(error))
