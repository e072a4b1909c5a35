"""An internet address and port as one number, which a datagram carries as its packet's address.

The number is complete: no table is kept that third parties could fill. 0 is no place: the other end of a link
that has only one.
"""

import ipaddress
from typing import Final

_PORT_BITS: Final = 16
_SCOPE_AT: Final = 144
_SCOPE: Final = 0xFFFF
_VERSION_6: Final = 1 << 160
"""Above 128 bits of address, 16 of port, and 16 for the interface of an address that has one."""
_ADDRESS_4: Final = 0xFFFF_FFFF
_ADDRESS_6: Final = (1 << 128) - 1
_PORT: Final = 0xFFFF


def number_of(host: str, port: int, scope: int = 0) -> int:
    """Return the number of a place; ValueError where the host is no address, or the port none from 1 on.

    `scope` is the number of the interface that a link-local address of version 6 belongs to.
    """
    if not (1 <= port <= _PORT and 0 <= scope <= _SCOPE):
        raise ValueError(f"{port} is no port")
    # The zone behind '%' is a name of this machine; the number of the interface goes into `scope`.
    address = ipaddress.ip_address(host.partition("%")[0])
    if address.version == 4:  # noqa: PLR2004 - the versions are 4 and 6
        return int(address) << _PORT_BITS | port
    return _VERSION_6 | scope << _SCOPE_AT | int(address) << _PORT_BITS | port


def host_and_port(number: int) -> tuple[str, int]:
    """Return the host and the port of a number that `number_of` has made."""
    address, port = number >> _PORT_BITS, number & _PORT
    if number & _VERSION_6:
        return str(ipaddress.IPv6Address(address & _ADDRESS_6)), port
    return str(ipaddress.IPv4Address(address & _ADDRESS_4)), port


def same_host(one: int, other: int) -> bool:
    """Return whether two places are on one host, whatever their ports."""
    # The scope lies above the address and is compared, too: link-local hosts differ by interface.
    return one >> _PORT_BITS == other >> _PORT_BITS


def scope_of(number: int) -> int | None:
    """Return the interface of an address of version 6, 0 where none is given; None for version 4."""
    return number >> _SCOPE_AT & _SCOPE if number & _VERSION_6 else None


def place_of(number: int) -> str:
    """Return a place as text, 192.168.1.10:14550; nothing for 0."""
    if number == 0:
        return ""
    host, port = host_and_port(number)
    return f"[{host}]:{port}" if number & _VERSION_6 else f"{host}:{port}"
