"""Description of a NatNet message: rows of fields, each with the versions that have it; both directions.

Everything is little endian, without padding and without a check sum. Bytes that do not fit raise a
`NatNetError` with their place; no other error leaves this module, whatever the bytes are.

Source: the layouts that OptiTrack's own clients of the NatNet SDK 2.9 to 4.2 read.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from struct import Struct, error
from typing import Any, Final, NamedTuple, Protocol, TypeAlias


class NatNetError(Exception):
    """A packet that cannot be read, or a value that cannot be sent: what, and where."""


class Version(NamedTuple):
    """Version of the protocol, as the server reports it."""

    major: int
    minor: int

    def __str__(self) -> str:
        """Format it as 3.1."""
        return f"{self.major}.{self.minor}"


FIRST: Final = Version(2, 9)
"""Of Motive 1.9; what is older is refused."""
LAST: Final = Version(4, 4)
NEVER: Final = Version(255, 255)
V2_11: Final = Version(2, 11)
V3_0: Final = Version(3, 0)
V4_0: Final = Version(4, 0)
V4_1: Final = Version(4, 1)
V4_2: Final = Version(4, 2)

Value: TypeAlias = Any


def known(version: Version) -> Version:
    """Return the version whose layout serves; NatNetError for one without a description.

    Assumed: a later 4.x is laid out as 4.4, since those versions carry the length of each list.
    """
    if not FIRST <= version < Version(LAST.major + 1, 0):
        raise NatNetError(f"NatNet {version} is not known; {FIRST} to {LAST} are")
    return min(version, LAST)


class Reader:
    """A payload, and how far it has been read."""

    __slots__ = ("at", "data", "end", "version")

    def __init__(self, data: bytes, version: Version) -> None:
        self.data: Final = data
        self.version: Final = version
        self.at = 0
        self.end = len(data)

    @property
    def left(self) -> int:
        """Count of bytes not read yet."""
        return self.end - self.at

    def take(self, size: int, name: str) -> int:
        """Return where the next `size` bytes are, and go beyond them."""
        # Checked before the read: a length from the network must not reach beyond the datagram.
        if size > self.end - self.at:
            raise NatNetError(f"{name} wants {size} bytes at byte {self.at}, and {self.left} are left")
        at, self.at = self.at, self.at + size
        return at


class ValueCodec(Protocol):
    """Codec of one value in a message."""

    def read(self, reader: Reader, name: str) -> Value:
        """Return the next value; `name` is for the refusal."""

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return the bytes of a value."""


class Number:
    """One number, or a row of them that belong together, as `struct` names them."""

    def __init__(self, code: str) -> None:
        self._layout: Final = Struct(f"<{code}")
        self._single: Final = len(self._layout.unpack(bytes(self._layout.size))) == 1

    def read(self, reader: Reader, name: str) -> Value:
        """Return it: a number, or a tuple."""
        values = self._layout.unpack_from(reader.data, reader.take(self._layout.size, name))
        return values[0] if self._single else values

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return its bytes."""
        del version
        try:
            return self._layout.pack(value) if self._single else self._layout.pack(*value)
        except (error, OverflowError, TypeError) as problem:
            raise NatNetError(f"{name}: {value!r} does not fit: {problem}") from None


class Text:
    """Characters up to a NUL. What is no UTF-8 is kept as it came."""

    def read(self, reader: Reader, name: str) -> str:
        """Return the text."""
        end = reader.data.find(b"\0", reader.at, reader.end)
        if end < 0:
            raise NatNetError(f"{name} at byte {reader.at} has no end")
        at = reader.take(end + 1 - reader.at, name)
        # Bytes that are no UTF-8 come through both ways unchanged.
        return reader.data[at:end].decode("utf-8", "surrogateescape")

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return the characters, and the NUL."""
        del version
        return _encoded(value, name) + b"\0"


class Padded:
    """Characters in a field of fixed size; what is behind their NUL is whatever was in the buffer before."""

    def __init__(self, size: int) -> None:
        self._size: Final = size

    def read(self, reader: Reader, name: str) -> str:
        """Return the text before the first NUL."""
        at = reader.take(self._size, name)
        return reader.data[at : at + self._size].partition(b"\0")[0].decode("utf-8", "surrogateescape")

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return the characters, filled up with NULs."""
        del version
        text = _encoded(value, name)
        if len(text) >= self._size:
            raise NatNetError(f"{name}: {len(text)} bytes do not fit into {self._size} with their NUL")
        return text.ljust(self._size, b"\0")


def _encoded(value: str, name: str) -> bytes:
    text = value.encode("utf-8", "surrogateescape")
    if b"\0" in text:
        raise NatNetError(f"{name}: {value!r} has a NUL in it")
    return text


@dataclass(frozen=True, slots=True)
class FieldRow:
    """One field of a record: its name there, its kind, and the versions that have it."""

    name: str
    kind: ValueCodec
    since: Version = FIRST
    before: Version = NEVER

    def is_in(self, version: Version) -> bool:
        """Return whether this version has it."""
        return self.since <= version < self.before


class RecordLayout:
    """A value class and its rows. What a version does not have is the class's default."""

    def __init__(self, made: type[Any], *rows: FieldRow) -> None:
        self._made: Final = made
        self._rows: Final = rows
        self._by_version: Final[dict[Version, tuple[FieldRow, ...]]] = {}

    def read(self, reader: Reader, name: str) -> Value:
        """Return the next record."""
        del name
        values = {row.name: row.kind.read(reader, row.name) for row in self._in(reader.version)}
        return self._made(**values)

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return its bytes."""
        del name
        rows = self._in(version)
        return b"".join([row.kind.write(getattr(value, row.name), version, row.name) for row in rows])

    def _in(self, version: Version) -> tuple[FieldRow, ...]:
        rows = self._by_version.get(version)
        if rows is None:
            rows = tuple(row for row in self._rows if row.is_in(version))
            self._by_version[version] = rows
        return rows


_COUNT: Final = Number("i")
_SIZE: Final = Number("I")


def _count(reader: Reader, name: str) -> int:
    """Return a count that the bytes left can hold, at one byte an item."""
    count: int = _COUNT.read(reader, f"the count of {name}")
    # A false count would else reserve memory for billions of items.
    if not 0 <= count <= reader.left:
        raise NatNetError(f"{name}: {count} of them do not fit into the {reader.left} bytes that are left")
    return count


class Items:
    """A count and so many items of a kind; a `announced` list has its size between them, from 4.1."""

    def __init__(self, item: ValueCodec, *, announced: bool = False) -> None:
        self._item: Final = item
        self._announced: Final = announced

    def read(self, reader: Reader, name: str) -> tuple[Value, ...]:
        """Return the items."""
        count = _count(reader, name)
        size = (
            _SIZE.read(reader, f"the size of {name}") if self._announced and reader.version >= V4_1 else None
        )
        begun = reader.at
        found = tuple([self._item.read(reader, name) for _ in range(count)])
        # From 4.1 on each list gives its size: a wrong layout is noticed at once, not fields later.
        if size is not None and reader.at - begun != size:
            raise NatNetError(
                f"{name}: {size} bytes long by its header, and {reader.at - begun} by its items"
            )
        return found

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return count, size and items."""
        items = b"".join([self._item.write(item, version, name) for item in value])
        count = _COUNT.write(len(value), version, name)
        if self._announced and version >= V4_1:
            return count + _SIZE.write(len(items), version, name) + items
        return count + items


class Columns:
    """A count, and then field by field what so many records have: all places, all numbers, all sizes."""

    def __init__(self, made: type[Any], *rows: FieldRow) -> None:
        self._made: Final = made
        self._rows: Final = rows

    def read(self, reader: Reader, name: str) -> tuple[Value, ...]:
        """Return the records."""
        count = _count(reader, name)
        rows = [row for row in self._rows if row.is_in(reader.version)]
        columns = [[row.kind.read(reader, row.name) for _ in range(count)] for row in rows]
        names = [row.name for row in rows]
        return tuple([self._made(**dict(zip(names, it, strict=True))) for it in zip(*columns, strict=True)])

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return the count and the columns."""
        columns = [
            row.kind.write(getattr(it, row.name), version, row.name)
            for row in self._rows
            if row.is_in(version)
            for it in value
        ]
        return _COUNT.write(len(value), version, name) + b"".join(columns)


class Tagged:
    """A value of one of several classes, behind its class's number and, from 4.1 on, its size."""

    def __init__(self, kinds: Mapping[int, tuple[type[Any], ValueCodec]]) -> None:
        self._kinds: Final = dict(kinds)
        self._numbers: Final = {made: number for number, (made, _) in kinds.items()}

    def read(self, reader: Reader, name: str) -> Value:
        """Return the value, None for one of a class that is not known and can be stepped over."""
        number: int = _COUNT.read(reader, f"the type of {name}")
        size = _SIZE.read(reader, f"the size of {name}") if reader.version >= V4_1 else None
        if number not in self._kinds:
            # Before 4.1 nothing gives the length of an unknown part, so all behind it is lost.
            if size is None:
                raise NatNetError(f"{name}: type {number} is not known, nor how long it is")
            reader.take(size, f"{name} of the unknown type {number}")
            return None
        begun = reader.at
        value = self._kinds[number][1].read(reader, name)
        if size is not None and reader.at - begun != size:
            raise NatNetError(
                f"{name}: {size} bytes long by its header, and {reader.at - begun} by its fields"
            )
        return value

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return number, size and value."""
        number = self._numbers[type(value)]
        data = self._kinds[number][1].write(value, version, name)
        size = _SIZE.write(len(data), version, name) if version >= V4_1 else b""
        return _COUNT.write(number, version, name) + size + data


class WhereThereIsRoom:
    """A value that some builds of one version send and some do not; the number of bytes left decides."""

    def __init__(self, kind: ValueCodec, left: int, *, since: Version) -> None:
        self._kind: Final = kind
        self._since: Final = since
        """The versions documented to have it; to others it is not sent."""
        self._left: Final = left
        """So many are left, itself included, where it is there."""

    def read(self, reader: Reader, name: str) -> Value:
        """Return the value; None where it is not there."""
        # The same version is sent with and without this field; only the length shows which.
        return self._kind.read(reader, name) if reader.left == self._left else None

    def write(self, value: Value, version: Version, name: str) -> bytes:
        """Return the value's bytes; nothing for None."""
        return b"" if value is None or version < self._since else self._kind.write(value, version, name)


def decode(kind: ValueCodec, payload: bytes, version: Version, name: str) -> Value:
    """Return the value that a whole payload is; NatNetError where it is short, or longer."""
    reader = Reader(payload, known(version))
    value = kind.read(reader, name)
    # Bytes left over show that the layout is another one: then no value before them is certain.
    if reader.left:
        raise NatNetError(f"{name}: {reader.left} bytes are left over behind it in NatNet {version}")
    return value


def encode(kind: ValueCodec, value: Value, version: Version, name: str) -> bytes:
    """Return the bytes of a value; NatNetError where it does not fit."""
    return kind.write(value, known(version), name)
