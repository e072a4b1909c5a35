"""How each MAVLink message lies in a payload: taken from pymavlink's message classes, once for each.

pymavlink does the same anew for every frame, which takes several times as long. Extensions and zeros at the
end as mavlink.io, "Packet Serialization", has them.
"""

from collections.abc import Callable, Iterable
from functools import cache
from operator import attrgetter
from typing import Any, Final

from pymavlink.dialects.v20 import common

_dialect: Final[Any] = common


class Layout:
    """One message's fields, in the order of the wire and in that of its constructor."""

    __slots__ = ("_kind", "_places", "_plain", "_struct", "_values", "checksum_seed")

    def __init__(self, kind: Any) -> None:
        """Take one of pymavlink's message classes."""
        self._kind = kind
        self._struct = kind.unpacker
        self.checksum_seed = bytes((kind.crc_extra,))
        """The byte that a frame's checksum takes in last: it differs where the definition differs."""
        # Of a text the object also has a readable form, under the field's own name.
        texts = {
            name: f"_{name}_raw"
            for name, type_, length in zip(
                kind.ordered_fieldnames, _in_wire_order(kind), kind.array_lengths, strict=True
            )
            if type_ == "char" and length
        }
        self._values: Callable[[Any], Any] = attrgetter(
            *(texts.get(name, name) for name in kind.ordered_fieldnames)
        )
        self._plain = all(length == 1 for length in kind.lengths) and len(kind.lengths) > 1
        first = 0
        places = []
        for length in kind.lengths:
            places.append(first if length == 1 else slice(first, first + length))
            first += length
        self._places = tuple(places[order] for order in kind.orders)

    def pack(self, message: Any) -> bytes:
        """Return a message's payload without the zeros at its end; one byte is left at least."""
        values = self._values(message)
        if not self._plain:
            values = _flat(values if isinstance(values, tuple) else (values,))
        payload: bytes = self._struct.pack(*values)
        return payload.rstrip(b"\0") or payload[:1]

    def unpack(self, payload: bytes) -> Any:
        """Return the message; what the payload lacks at its end is zero, what is too much does not count."""
        size = self._struct.size
        values = self._struct.unpack(payload[:size].ljust(size, b"\0"))
        fields: list[Any] = []
        for place in self._places:
            value = values[place]
            if isinstance(value, bytes):
                value = value.rstrip(b"\0")
            fields.append(list(value) if isinstance(value, tuple) else value)
        return self._kind(*fields)


def _flat(values: Iterable[Any]) -> list[Any]:
    flat: list[Any] = []
    for value in values:
        if isinstance(value, list | tuple):
            flat += value
        else:
            flat.append(value)
    return flat


def _in_wire_order(kind: Any) -> list[str]:
    types = dict(zip(kind.fieldnames, kind.fieldtypes, strict=True))
    return [types[name] for name in kind.ordered_fieldnames]


@cache
def layout_of(number: int) -> Layout | None:
    """Return a message's layout; None for one that the dialect does not know."""
    kind = _dialect.mavlink_map.get(number)
    return None if kind is None else Layout(kind)
