"""Firmata 2.5: MIDI-like messages of three bytes, and system-exclusive ones of 7-bit data; a row each.

Source: firmata/protocol: protocol.md, i2c.md, encoder.md; firmata/arduino, StandardFirmata.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import Final

BAUD: Final = 57_600
START: Final = 0xF0
END: Final = 0xF7
MAX_DATA: Final = 64
"""Size in bytes of a system-exclusive message that a board keeps."""
LONGEST_FROM_BOARD: Final = 2_048
"""... and that a host does: more than all pins' modes."""
CHANNELLED: Final = 0xF0
"""Below it a command's low four bits are a pin or a port."""
SEVEN: Final = 0x7F

# Commands

ANALOG: Final = 0xE0
DIGITAL: Final = 0x90
REPORT_ANALOG: Final = 0xC0
REPORT_DIGITAL: Final = 0xD0
PIN_MODE: Final = 0xF4
PIN_VALUE: Final = 0xF5
VERSION: Final = 0xF9
RESET: Final = 0xFF

# System-exclusive commands

ENCODER: Final = 0x61
MAPPING_QUERY: Final = 0x69
MAPPING: Final = 0x6A
CAPABILITY_QUERY: Final = 0x6B
CAPABILITY: Final = 0x6C
PIN_STATE_QUERY: Final = 0x6D
PIN_STATE: Final = 0x6E
EXTENDED_ANALOG: Final = 0x6F
STRING: Final = 0x71
I2C_REQUEST: Final = 0x76
I2C_REPLY: Final = 0x77
I2C_CONFIG: Final = 0x78
FIRMWARE: Final = 0x79
SAMPLING: Final = 0x7A

EXCLUSIVE: Final[Mapping[int, str]] = MappingProxyType(
    {
        ENCODER: "encoder",
        MAPPING_QUERY: "which channels",
        MAPPING: "channels",
        CAPABILITY_QUERY: "which modes",
        CAPABILITY: "modes",
        PIN_STATE_QUERY: "which state",
        PIN_STATE: "state",
        EXTENDED_ANALOG: "analog output",
        STRING: "text",
        I2C_REQUEST: "I2C request",
        I2C_REPLY: "I2C reply",
        I2C_CONFIG: "I2C set-up",
        FIRMWARE: "firmware",
        SAMPLING: "sampling interval",
    }
)
"""Subject of each system-exclusive command."""

ENCODER_REQUESTS: Final[Mapping[int, str]] = MappingProxyType(
    {
        0x00: "attach",
        0x01: "report",
        0x02: "report all",
        0x03: "count from 0",
        0x04: "report all by itself",
        0x05: "detach",
    }
)
"""Meaning of a host's encoder message, by its first byte; a board's has none."""

# How an I2C request is to be served

I2C_WRITE: Final = 0x00
I2C_READ: Final = 0x08
I2C_CONTINUOUS: Final = 0x10
I2C_STOP: Final = 0x18
I2C_TEN_BITS: Final = 0x20
I2C_RESTART: Final = 0x40


@dataclass(frozen=True, slots=True)
class FirmataCommand:
    """One message that is not system-exclusive: its first byte, and how many bytes follow it, either way."""

    code: int
    name: str
    bytes_to_board: int
    """From the host."""
    bytes_from_board: int = 0
    """From the board; a board reports some of them only."""


ROWS: Final[tuple[FirmataCommand, ...]] = (
    FirmataCommand(ANALOG, "analog I/O", 2, 2),
    FirmataCommand(DIGITAL, "digital port", 2, 2),
    FirmataCommand(REPORT_ANALOG, "report analog", 1),
    FirmataCommand(REPORT_DIGITAL, "report digital port", 1),
    FirmataCommand(PIN_MODE, "pin mode", 2),
    FirmataCommand(PIN_VALUE, "digital pin", 2),
    FirmataCommand(VERSION, "protocol version", 0, 2),
    FirmataCommand(RESET, "system reset", 0),
)
COMMANDS: Final[Mapping[int, FirmataCommand]] = MappingProxyType({row.code: row for row in ROWS})


@dataclass(frozen=True, slots=True)
class Message:
    """One message: a command with its channel, or a system-exclusive one; data as 7-bit bytes."""

    code: int
    data: bytes = b""
    channel: int = 0
    exclusive: bool = False


def encode(message: Message) -> bytes:
    """Return a message's bytes."""
    if message.exclusive:
        return bytes((START, message.code)) + message.data + bytes((END,))
    return bytes((message.code | message.channel,)) + message.data


def pairs(data: Sequence[int]) -> bytes:
    """Return bytes as 7-bit pairs, low one first; also numbers of 14 bits."""
    return bytes(part for it in data for part in (it & SEVEN, it >> 7 & SEVEN))


def unpaired(data: bytes) -> tuple[int, ...]:
    """Return what pairs say; a lonely byte at the end is a pair's low one, as the board takes it."""
    padded = data + bytes(len(data) % 2)
    return tuple(low | high << 7 for low, high in zip(padded[::2], padded[1::2], strict=True))


def exclusive(code: int, data: bytes = b"") -> bytes:
    """Return a system-exclusive message."""
    return encode(Message(code, data, exclusive=True))


def i2c_write(address: int, data: bytes) -> bytes:
    """Return a request that writes bytes to a 7-bit address."""
    return exclusive(I2C_REQUEST, bytes((address, I2C_WRITE)) + pairs(data))


def i2c_read(address: int, register: int, count: int) -> bytes:
    """Return a request that reads bytes from a register on."""
    return exclusive(I2C_REQUEST, bytes((address, I2C_READ)) + pairs((register, count)))


@dataclass(frozen=True, slots=True)
class I2cRead:
    """The data of an I2C reply, with its address and register."""

    address: int
    register: int
    data: bytes


def decode_i2c(message: Message) -> I2cRead | None:
    """Return the content of an I2C reply; None for another message, or half a reply."""
    values = unpaired(message.data)
    # The I2C address and register come before the data, each as a pair of 7-bit bytes.
    if not message.exclusive or message.code != I2C_REPLY or len(values) < len(("address", "register")):
        return None
    return I2cRead(values[0], values[1], bytes(it & 0xFF for it in values[2:]))


@dataclass(frozen=True, slots=True)
class Counted:
    """An encoder's number, and its count."""

    encoder: int
    count: int


def decode_counts(message: Message) -> tuple[Counted, ...]:
    """Return a report of encoders, each a sign and its number, then four times seven bits; else none."""
    data = message.data
    # Five bytes an encoder: sign and number, then the count's 28 bits.
    if not message.exclusive or message.code != ENCODER or len(data) % _COUNT:
        return ()
    return tuple(_counted(data[place : place + _COUNT]) for place in range(0, len(data), _COUNT))


def _counted(data: bytes) -> Counted:
    # Least significant seven bits first.
    size = sum(part << 7 * index for index, part in enumerate(data[1:]))
    # Bit 6 is the sign, bits 0 to 5 are the encoder: sign and size, no two's complement.
    return Counted(data[0] & 0x3F, -size if data[0] & 0x40 else size)


_COUNT: Final = 5
"""Size in bytes of one encoder in a report."""


class Parser:
    """Either end: it takes bytes and finds messages. What is no message is passed over."""

    def __init__(self, *, from_board: bool = False) -> None:
        self._from_board: Final = from_board
        self._room: Final = LONGEST_FROM_BOARD if from_board else MAX_DATA
        self._exclusive = False
        self._command: FirmataCommand | None = None
        self._channel = 0
        self._missing = 0
        self._data = bytearray()

    def receive(self, chunk: bytes) -> Iterator[Message]:
        """Take bytes; yield what they complete."""
        for byte in chunk:
            found = self.take(byte)
            if found is not None:
                yield found

    def take(self, byte: int) -> Message | None:
        """Take one byte; return the message that it completes."""
        if self._exclusive:
            return self._take_exclusive(byte)
        # Data bytes have bit 7 at 0; a byte with bit 7 begins a new message, whatever is missing.
        if self._missing and byte <= SEVEN:
            self._data.append(byte)
            self._missing -= 1
            if self._missing or self._command is None:
                return None
            return Message(self._command.code, bytes(self._data), self._channel)
        return self._begin(byte)

    def _take_exclusive(self, byte: int) -> Message | None:
        if byte != END:
            # As the board does: what goes beyond its buffer is lost, and the message ends all the same.
            if len(self._data) < self._room:
                self._data.append(byte)
            return None
        self._exclusive = False
        return Message(self._data[0], bytes(self._data[1:]), exclusive=True) if self._data else None

    def _begin(self, byte: int) -> Message | None:
        if byte == START:
            self._exclusive, self._missing = True, 0
            self._data.clear()
            return None
        # Below 0xF0 the low half of the byte is a channel, as in MIDI.
        row = COMMANDS.get(byte & 0xF0 if byte < CHANNELLED else byte)
        if row is None:
            return None
        self._channel = byte & 0x0F if byte < CHANNELLED else 0
        self._command, self._missing = row, row.bytes_from_board if self._from_board else row.bytes_to_board
        self._data.clear()
        return None if self._missing else Message(row.code, channel=self._channel)
