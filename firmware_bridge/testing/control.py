"""Control of a running `emulate`: faults, inputs and restarts, from another program.

    with control() as devices:
        number = devices.inject("shaft_blocked", node="one")
        devices.clear(number)

The protocol is one JSON object a line: see docs/control.md.
"""

import json
import os
import socket
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import Any, Final, Self

from firmware_bridge.runtime.ports.control_socket import SUFFIX, runtime_folder

WITHIN_S: Final = 10.0
"""Time for an answer, on a machine that has much to do."""


class ControlError(Exception):
    """No such program, or a request that it refuses: which, why, and what to do."""


class Control:
    """A connection to one program; its methods raise ControlError."""

    def __init__(self, where: Path | tuple[str, int], token: str = "") -> None:
        """Connect to a Unix socket, or to a TCP port with its token."""
        self._count = 0
        family = socket.AF_UNIX if isinstance(where, Path) else socket.AF_INET
        self._socket: Final = socket.socket(family, socket.SOCK_STREAM)
        self._socket.settimeout(WITHIN_S)
        try:
            self._socket.connect(str(where) if isinstance(where, Path) else where)
        except OSError as error:
            self._socket.close()
            raise ControlError(f"no program answers at {where}: {error.strerror or error}") from error
        self._reader: Final = self._socket.makefile("rb")
        if token:
            self._send({"token": token})

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the connection; what was injected stays."""
        self.close()

    def inject(self, fault: str, *, for_s: float | None = None, **keys: Any) -> int:
        """Let a fault begin now, by its name and keys in missions; return its number, for `clear`."""
        if for_s is not None:
            keys["for_s"] = for_s
        return int(self.request("inject", fault=fault, keys=keys)["number"])

    def clear(self, number: int | None = None) -> list[int]:
        """End a fault that is on, or all; return the numbers of those that were ended."""
        return list(self.request("clear", number=number)["cleared"])

    def state(self) -> dict[str, Any]:
        """Return the devices, the faults that are on, and the names that can be set."""
        return self.request("state")

    def set(self, values: Mapping[str, float]) -> None:
        """Set inputs, voltages and tunable parameters of the plant, by their names in `state`."""
        self.request("set", values=dict(values))

    def restart(self, node: str | int) -> None:
        """Take a drive's supply away and give it back, or reset the board on a link."""
        self.request("restart", node=node)

    def shutdown(self) -> None:
        """End the program in good order."""
        self.request("shutdown")

    def request(self, do: str, **keys: Any) -> dict[str, Any]:
        """Send one request and return its answer."""
        self._count += 1
        self._send({"id": self._count, "do": do, **keys})
        try:
            line = self._reader.readline()
        except OSError as error:
            raise ControlError(f"no answer to {do} within {WITHIN_S:g} s") from error
        if not line:
            raise ControlError(f"{do}: the program has closed the connection; over TCP, check the token")
        answer: dict[str, Any] = json.loads(line)
        if not answer["ok"]:
            raise ControlError(str(answer["error"]))
        return answer

    def close(self) -> None:
        """Close the connection."""
        self._reader.close()
        self._socket.close()

    def _send(self, request: dict[str, Any]) -> None:
        try:
            self._socket.sendall(json.dumps(request).encode() + b"\n")
        except OSError as error:
            raise ControlError(f"the program has ended: {error.strerror or error}") from error


def running() -> dict[str, Path]:
    """Return the sockets of this user's running programs, by their names as `rars-4711`."""
    found = {}
    for path in sorted(runtime_folder().glob(f"*{SUFFIX}")):
        pid = path.stem.rpartition("-")[2]
        if pid.isdecimal() and _lives(int(pid)):
            found[path.stem] = path
        else:
            # One that was killed has left it behind.
            with suppress(OSError):
                path.unlink()
    return found


def of_process(pid: int) -> Control:
    """Connect to the program with this number at the system."""
    for name, path in running().items():
        if name.endswith(f"-{pid}"):
            return Control(path)
    raise ControlError(f"process {pid} has no control port; start it without --control none")


def control(name: str = "", token: str = "") -> Control:
    """Connect to a running program: by its name or its begin, by HOST:PORT, or to the only one."""
    host, _, port = name.rpartition(":")
    if host and port.isdecimal():
        return Control((host, int(port)), token)
    known = running()
    fitting = [one for one in known if one == name] or [one for one in known if one.startswith(name)]
    if len(fitting) == 1:
        return Control(known[fitting[0]])
    there = ", ".join(known) or "none; start one with `firmware-bridge emulate`"
    problem = f"'{name}' fits {len(fitting)}" if name else f"{len(fitting)} programs run"
    raise ControlError(f"{problem}; name one: {there}")


def _lives(pid: int) -> bool:
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except PermissionError:
        return True
    return True
