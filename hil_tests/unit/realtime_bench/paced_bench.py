"""A bench at the pace of a test's own clock, behind its control desk, with or without a station outside."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Final

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.control.desk import CONTROL, Desk
from emulators.control.live import Live
from emulators.paced import OutsideOperator, PacedRig
from emulators.rig import Rig
from emulators.run import RunOrder, operator_of
from firmware_bridge.mavlink.frames import Codec, dialect
from firmware_bridge.node import OPERATOR
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds, from_seconds
from firmware_bridge.wire.internet import number_of

STATION: Final = number_of("127.0.0.1", 14_550)
CLIENT: Final = 1


class PacedBench:
    """A mission of a robot; `runs` moves the clock, and keeps what leaves for the station."""

    def __init__(self, robot: str, mission: str, folder: Any, *, outside: bool, end_s: float = 60.0) -> None:
        machine = find(robot)
        setup = bench_setup_of(machine)
        script = mission_of(mission, machine, setup)
        self.operator: Final = OutsideOperator() if outside else None
        order = RunOrder(machine, setup, mission, script, 0, folder, operator=self.operator)
        self.rig: Final = Rig(
            script.on(machine), setup, operator_of(order), noise=script.noise, injects=outside
        )
        rig = self.rig
        live = Live(machine, rig.devices, rig.world, rig.devices.plant, rig.faults, in_reach=True)
        paced = PacedRig(self.rig, from_seconds(end_s), self.operator)
        self.desk: Final = Desk(paced, live, lambda _: None)
        self.now: Nanoseconds = 0
        self.sent: Final[list[Packet]] = []
        self._codec: Final = Codec(255, 190)
        self._wake_at: Nanoseconds = 0
        self._read = 0
        """Number of packets that a test has read."""

    def runs(self, milliseconds: float) -> list[Any]:
        """Let the clock run; return the messages that have left for the station since."""
        end = self.now + round(milliseconds * MILLISECOND)
        while self._wake_at <= end:
            self.now = max(self.now, self._wake_at)
            self._wake_at = NEVER
            self._take(self.desk.wake(self.now))
        self.now = end
        datagrams = [packet.payload for packet in self.sent[self._read :] if packet.link == OPERATOR]
        self._read = len(self.sent)
        return [message for datagram in datagrams for message in self._codec.decode(datagram)]

    def does(self, do: str, **keys: Any) -> dict[str, Any]:
        """Send a request over the control port; return its answer."""
        line = json.dumps({"do": do, **keys}).encode()
        reaction = self.desk.receive(Packet(CONTROL, CLIENT, line), self.now)
        (answer,) = (one for one in reaction.sent if one.link == CONTROL)
        self._take(reaction)
        answered: dict[str, Any] = json.loads(answer.payload)
        return answered

    def orders(self, number: int, *params: float) -> tuple[int, str]:
        """Send a command from outside; return its result, and the texts of the next 300 ms."""
        self._states(
            dialect.MAVLink_command_long_message(1, 1, number, 0, *params, *(0.0,) * (7 - len(params)))
        )
        messages = self.stays(300)
        results = [
            one.result for one in messages if one.get_type() == "COMMAND_ACK" and one.command == number
        ]
        return results[0], "".join(one.text for one in messages if one.get_type() == "STATUSTEXT")

    def stays(self, milliseconds: int) -> list[Any]:
        """Let a station hold its stick in the middle so long; return the messages to it."""
        messages = []
        for at in range(0, milliseconds, 50):
            if at % 500 == 0:
                self._states(dialect.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
            self._states(dialect.MAVLink_manual_control_message(1, 0, 0, 500, 0, 0))
            messages += self.runs(50)
        return messages

    def _states(self, message: Any) -> None:
        packet = Packet(OPERATOR, STATION, self._codec.encode(message))
        self._take(self.desk.receive(packet, self.now))

    def _take(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        self.sent.extend(reaction.sent)


@contextmanager
def paced(robot: str, mission: str, folder: Any, *, outside: bool = False) -> Iterator[PacedBench]:
    """Start a bench; let go of its plant at the end."""
    bench = PacedBench(robot, mission, folder, outside=outside)
    try:
        yield bench
    finally:
        bench.rig.finish()
