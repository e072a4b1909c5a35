"""One EPOS2 on CAN as the bridge sees it: tasks, set-points, what it has sent. Bytes and time only."""

from collections import deque
from typing import Final

from firmware_bridge.drivers.driver import Demand, Feedback, StartupError, Stop, Task, Tells
from firmware_bridge.drivers.epos2.can.feedback import CanFeedback
from firmware_bridge.drivers.epos2.feedback import TELLS
from firmware_bridge.drivers.epos2.inputs_outputs import ObjectRequest
from firmware_bridge.drivers.epos2.set_point import set_point
from firmware_bridge.drivers.epos2.setup import configuration
from firmware_bridge.drivers.epos2.task_runner import TaskRunner
from firmware_bridge.drivers.script_runner import ScriptRunner
from firmware_bridge.drivers.sdo_client import NodeClient
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Output
from firmware_bridge.robot.settings.epos2 import Epos2Link
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire import canopen


class Epos2OnCan:
    """One drive; a `firmware_bridge.drivers.driver.Driver`."""

    __slots__ = (
        "_answers",
        "_axis",
        "_client",
        "_feedback",
        "_requests",
        "_scripts",
        "_set_point",
        "_tasks",
        "wake_at",
    )

    def __init__(self, axis: Axis, link: Epos2Link, outputs: tuple[Output, ...] = ()) -> None:
        """Take the axis, its link, and what is switched at its drive."""
        self._axis: Final = axis
        self._answers: Final = canopen.SDO_RESPONSE + axis.settings.node
        """Where its SDO server answers."""
        self._feedback: Final = CanFeedback(axis)
        self.wake_at: Nanoseconds = NEVER
        """When it wants to be woken. Asked for after every packet: so it is an attribute."""
        self._set_point = set_point(axis, self._feedback)
        self._client = NodeClient(axis.link, axis.settings.node)
        self._scripts = ScriptRunner(self._client)
        rows = configuration(axis, link, outputs)
        self._tasks = TaskRunner(axis, self._feedback, self._set_point, self._scripts, rows)
        self._requests: deque[ObjectRequest] = deque()
        """Beside the tasks; the first one is under way."""

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""
        return self._axis

    @property
    def tells(self) -> frozenset[Tells]:
        """What it can tell."""
        return TELLS

    @property
    def feedback(self) -> Feedback:
        """What it has reported."""
        return self._feedback.published()

    @property
    def sampled_at(self) -> Nanoseconds:
        """When its newest sample was taken."""
        return self._feedback.sampled_at

    @property
    def busy(self) -> bool:
        """Whether tasks are under way."""
        return self._tasks.busy

    @property
    def failure(self) -> StartupError | None:
        """Why the last tasks failed; None where they did not."""
        return self._tasks.failure

    @property
    def unpowered(self) -> bool:
        """Whether its newest statusword tells a state without torque; not once power was asked for."""
        return self._feedback.unpowered

    @property
    def configured(self) -> bool:
        """Whether its set-up is in force and it listens to set-points."""
        return self._tasks.configured

    @property
    def set_ups(self) -> int:
        """How often its set-up was written so far."""
        return self._tasks.set_ups

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Do these tasks in order, in place of those under way."""
        for request in self._requests:
            request.over = True
        self._requests.clear()
        return self._waiting(self._tasks.begin(tasks, now))

    def command(self, demand: Demand) -> tuple[Packet, ...]:
        """Send a demand; while tasks are under way only quick stop or power off.

        Those end the tasks, unless they stop the drive themselves.
        """
        if self.busy:
            if demand not in (Stop.QUICK_STOP, Stop.POWER_OFF):
                return ()
            if not self._tasks.stopping:
                self._tasks.end()
            self.wake_at = self._scripts.wake_at
        return (self._set_point.demand(demand),)

    def release(self) -> tuple[Packet, ...]:
        """End the handshake of a new position, where one is open."""
        packet = None if self.busy else self._set_point.release()
        return () if packet is None else (packet,)

    def synchronised(self, now: Nanoseconds) -> None:
        """Learn that a SYNC leaves now: the next sample was taken then."""
        self._feedback.synchronised(now)

    def request(self, request: ObjectRequest, now: Nanoseconds) -> tuple[Packet, ...]:
        """Read or write an object behind those that wait; dropped while tasks are under way."""
        if self.busy:
            request.over = True
            return ()
        self._requests.append(request)
        return self._waiting(self._next_request(now))

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet of this drive; one that makes no sense is ignored."""
        if packet.address == self._answers:
            sent = self._client.hear(packet.payload, now) + self._scripts.go_on(now)
            return self._went_on(sent, now)
        self._feedback.hear(packet.address, packet.payload, now)
        return self._waiting(self._tasks.proceed(now)) if self.busy else ()

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._went_on(self._scripts.wake(now), now)

    def _went_on(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        outcome = None if self.busy else self._scripts.take()
        if outcome is not None and self._requests:
            self._requests.popleft().end(outcome, now)
            sent += self._next_request(now)
        return self._waiting(self._tasks.go_on(sent, now))

    def _next_request(self, now: Nanoseconds) -> tuple[Packet, ...]:
        if not self._requests or not self._scripts.idle:
            return ()
        return self._scripts.ask(self._requests[0].transfer, now)

    def _waiting(self, sent: tuple[Packet, ...]) -> tuple[Packet, ...]:
        """Pass on what is to be sent, once it is known how long to wait for what comes of it."""
        self.wake_at = self._scripts.wake_at
        return sent
