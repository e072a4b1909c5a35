"""The control desk: a node around emulated devices that carries out what comes over the control port."""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any, Final, NoReturn

from emulators.bench.records import FaultRecord
from emulators.control.keys import WordError
from emulators.control.lines import VERSION, LineError, line_of, request_of
from emulators.control.live import Live
from emulators.control.settable import Settable, SettingError
from emulators.control.words import beginning, fault_of, plan
from firmware_bridge.node import Finite, Node, Stoppable
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot.problems import near
from firmware_bridge.runtime.clock import LivedClock
from firmware_bridge.units import Nanoseconds, to_seconds
from fmu.errors import PlantError

CONTROL: Final = "control"
"""The link of the control port; an address is a client."""
LARGEST: Final = 1e12
"""No input of a plant has larger numbers."""
OFF_S: Final = 0.2
"""Time without supply of a drive that is restarted."""


class RefusedError(Exception):
    """A request that cannot be carried out: what, and why."""


class Desk:
    """A node that is finished once a client has ended it; all else passes to the devices."""

    def __init__(
        self, node: Node, live: Live, report: Callable[[str], None], clock: LivedClock | None = None
    ) -> None:
        """Take the devices as they are carried, their parts, what reports to the user, and the clock."""
        self._node: Final = node
        self._live: Final = live
        self._report: Final = report
        self._clock: Final = clock
        self._faults: Final = live.faults
        self._now: Nanoseconds = 0
        """The instant of the request, by the clock of the runner."""
        self._settable: Final = Settable(live.devices, live.plant)
        self._ended = False
        self._sent: list[Packet] = []
        """What the devices have sent while a request is carried out."""
        self._does: Final[Mapping[str, Callable[[dict[str, Any]], dict[str, Any]]]] = MappingProxyType(
            {
                "inject": self._inject,
                "clear": self._clear,
                "state": self._state,
                "set": self._set,
                "restart": self._restart,
                "shutdown": self._shutdown,
            }
        )

    @property
    def finished(self) -> bool:
        """True once a client has ended it, or the devices' time is over."""
        return self._ended or (isinstance(self._node, Finite) and self._node.finished)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Carry out a request of the control port; pass on everything else."""
        if packet.link != CONTROL:
            return self._node.receive(packet, now)
        # The devices come to this instant first, and what it changes leaves at once.
        self._now, self._sent = now, [*self._node.wake(now).sent]
        answer = self._answer(packet.payload)
        after = self._node.wake(now)
        sent = (*self._sent, *after.sent, Packet(CONTROL, packet.address, line_of(answer)))
        return Reaction(sent, after.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the devices."""
        return self._node.wake(now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the devices, where they can be stopped."""
        return self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()

    def _answer(self, line: bytes) -> dict[str, Any]:
        at_s = to_seconds(self._live.carrier.now)
        number: Any = None
        try:
            request = request_of(line)
            number = request.get("id")
            work = self._does.get(request["do"], self._unknown)
            return {"id": number, "ok": True, "at_s": at_s, **work(request)}
        except (LineError, RefusedError, WordError, SettingError, PlantError) as error:
            return {"id": number, "ok": False, "at_s": at_s, "error": str(error)}

    def _unknown(self, request: dict[str, Any]) -> NoReturn:
        raise RefusedError(f"no such request as '{request['do']}'; {near(request['do'], self._does)}")

    def _inject(self, request: dict[str, Any]) -> dict[str, Any]:
        kind, keys = request.get("fault"), request.get("keys", {})
        if not isinstance(kind, str) or not isinstance(keys, dict):
            raise RefusedError('inject: give "fault", a name, and "keys", an object')
        number = self._begin(kind, keys)
        return {"number": number}

    def _begin(self, kind: str, keys: dict[str, Any]) -> int:
        """Begin a fault now; return its number."""
        live = self._live
        fault = fault_of(live, {"kind": kind, **keys, "at_s": to_seconds(live.carrier.now)})
        number = plan(live, [fault])
        try:
            # Now, so that what cannot begin is an answer, and not the devices' end.
            self._sent += self._node.wake(self._now).sent
        except Exception as error:
            self._faults.forget(number)
            raise RefusedError(f"{kind}: {live.robot.name} cannot have it: {error}") from error
        self._report(beginning(live, fault))
        return number

    def _clear(self, request: dict[str, Any]) -> dict[str, Any]:
        number, standing = request.get("number"), self._faults.standing
        if number is not None and number not in standing:
            known = ", ".join(map(str, standing)) or "none"
            raise RefusedError(f"clear: no fault {number} is on; numbers of those that are: {known}")
        cleared = standing if number is None else (number,)
        for one in cleared:
            record = self._faults.record_of(one)
            self._faults.clear(one)
            self._report(f"fault {record.kind} cleared at {to_seconds(self._live.carrier.now):.6f} s")
        return {"cleared": list(cleared)}

    def _state(self, _request: dict[str, Any]) -> dict[str, Any]:
        return {
            "version": VERSION,
            "emulates": self._live.robot.name,
            "devices": {name: self._live.carrier.here(name) for name in self._live.devices.stations},
            "faults": [
                {"number": one, **_as_json(self._faults.record_of(one))} for one in self._faults.standing
            ],
            "settable": list(self._settable.names),
            "stalled_s": 0.0 if self._clock is None else to_seconds(self._clock.stalled),
        }

    def _set(self, request: dict[str, Any]) -> dict[str, Any]:
        values = request.get("values")
        if not isinstance(values, dict) or not values:
            raise RefusedError('set: give "values", an object with numbers by name')
        for name, value in values.items():
            if isinstance(value, bool) or not isinstance(value, int | float) or abs(value) > LARGEST:
                raise RefusedError(f"set: {name} must be a number up to {LARGEST:g}, but it is {value!r:.40}")
        # All are possible before the first is set.
        settings = [self._settable.setting(name, float(value)) for name, value in values.items()]
        for (name, value), put in zip(values.items(), settings, strict=True):
            put()
            self._report(f"{name} set to {value:g} at {to_seconds(self._live.carrier.now):.6f} s")
        return {"set": values}

    def _restart(self, request: dict[str, Any]) -> dict[str, Any]:
        node = request.get("node")
        if not isinstance(node, str | int):
            raise RefusedError('restart: give "node", the name or number of a drive, or a board\'s link')
        if node in self._live.robot.links:
            return {"number": self._begin("board_reset", {"link": node})}
        return {"number": self._begin("drive_restart", {"node": node, "for_s": OFF_S})}

    def _shutdown(self, _request: dict[str, Any]) -> dict[str, Any]:
        self._ended = True
        return {}


def _as_json(record: FaultRecord) -> dict[str, Any]:
    return {"fault": record.kind, "nodes": list(record.nodes), "began_s": to_seconds(record.began)}
