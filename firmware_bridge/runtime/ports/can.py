"""Opening of a CAN bus by interface and channel, given or from python-can's own configuration."""

from collections.abc import Callable
from typing import Final

from firmware_bridge.runtime.ports.port import Port, PortError
from firmware_bridge.runtime.ports.socketcan import SocketCanPort

KERNEL: Final = "socketcan"
"""The interface that needs no library."""


def _nothing(_text: str) -> None:
    """Drop a text."""


def open_can(
    interface: str | None = None,
    channel: str | None = None,
    bit_rate: int | None = None,
    *,
    default_bit_rate: int = 1_000_000,
    say: Callable[[str], None] = _nothing,
) -> Port:
    """Open a CAN port; what is None comes from python-can's configuration file or environment; PortError.

    `default_bit_rate` holds where neither the argument nor the configuration names one. `say` takes what is
    odd about the interface.
    """
    if interface == KERNEL and channel:
        return SocketCanPort(channel, bit_rate or default_bit_rate)
    # A quarter of a second of processor time, which a stop on the kernel's own bus must not wait for.
    from firmware_bridge.runtime.ports import python_can  # noqa: PLC0415 - see above

    given = {"interface": interface, "channel": channel, "bitrate": bit_rate}
    found = python_can.configuration({key: value for key, value in given.items() if value is not None})
    found.setdefault("bitrate", default_bit_rate)
    interface = found["interface"]
    for key, value in python_can.DEFAULTS.get(interface, {}).items():
        if found.get(key) is None:
            found[key] = value
    channel = found["channel"]
    name = f"CAN interface {interface} channel {channel}"
    if interface in python_can.CAUTIONS:
        say(python_can.CAUTIONS[interface])
    if interface != KERNEL:
        return python_can.PythonCanPort(name, found)
    if channel in {None, ""}:
        raise PortError(f"cannot open {name}: name the channel, for example can0")
    return SocketCanPort(str(channel), int(found["bitrate"]))
