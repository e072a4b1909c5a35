"""One drive on CAN as the bridge sees it: tasks, set-points, what it has sent. Bytes and time only."""

from collections import deque
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.sdo_client import NodeClient
from firmware_bridge.canopen_drive.driver.can_feedback import CanFeedback
from firmware_bridge.canopen_drive.driver.drive import Drive
from firmware_bridge.canopen_drive.driver.object_request import ObjectRequest
from firmware_bridge.canopen_drive.driver.process_data import BRAKING, BRAKING_COB_ID
from firmware_bridge.canopen_drive.driver.product import DriveProduct
from firmware_bridge.canopen_drive.driver.scale import in_units
from firmware_bridge.canopen_drive.driver.setup_object import SetupObject
from firmware_bridge.canopen_drive.settings import DriveAxis
from firmware_bridge.drivers.driver import SetPoint, Speed
from firmware_bridge.drivers.life_cycle import Task, Transition
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis
from firmware_bridge.units import NEVER, Nanoseconds


class DriveOnCan(Drive[CanFeedback]):
    """One drive; a `firmware_bridge.drivers.driver.Driver`."""

    __slots__ = ("_answers", "_brakes_between", "_braking", "_client", "_requests", "wake_at")

    def __init__(self, axis: Axis, product: DriveProduct, rows: tuple[SetupObject, ...]) -> None:
        """Take the axis, what its drive is, and its set-up."""
        self._client: Final = NodeClient(axis.link, DriveAxis.of(axis).node)
        super().__init__(axis, CanFeedback(axis, product), self._client, rows)
        self._answers: Final = cia301.SDO_RESPONSE + DriveAxis.of(axis).node
        """Identifier of its SDO server's answers."""
        self._braking: Final = BRAKING_COB_ID + DriveAxis.of(axis).node
        self._brakes_between: Final = _braking_bounds(axis)
        self.wake_at: Nanoseconds = NEVER
        """Time of its next wake-up. Read after every packet: so it is an attribute."""
        self._requests: deque[ObjectRequest] = deque()
        """Beside the tasks; the first one is under way."""

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or that one of its tasks, in place of what is under way."""
        self._drop_requests()
        return self._waiting(self._tasks.begin(transition, now, task))

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Have it count from this position, in the axis's unit, where it stands."""
        self._drop_requests()
        return self._waiting(self._tasks.set_zero(position, now))

    def command(self, set_point: SetPoint) -> tuple[Packet, ...]:
        """Send a set-point; while tasks are under way only what stops.

        Those end the tasks, unless they stop the drive themselves.
        """
        busy, meant = bool(self._life.tasks), self._tasks.lets(set_point)
        if meant is None:
            return ()
        if busy:
            self.wake_at = self._scripts.wake_at
        return (*self._brakes(set_point), self._set_point.frame_for(meant))

    def _brakes(self, set_point: SetPoint) -> tuple[Packet, ...]:
        """Return the frame of the quick stop deceleration that goes with a speed, where it may be lowered."""
        bounds = self._brakes_between
        # During a stop the last one stays: both axes of a ratio shall come to rest together.
        if bounds is None or not isinstance(set_point, Speed):
            return ()
        least, most = bounds
        wanted = set_point.braking * most
        # Written so that a NaN brakes as hard as it may.
        value = round(wanted) if least <= wanted <= most else least if wanted < least else most
        return (Packet(self._axis.link, self._braking, BRAKING.pack(value)),)

    def release(self) -> tuple[Packet, ...]:
        """End the handshake of a new position, where one is open."""
        packet = None if self._life.tasks else self._set_point.release()
        return () if packet is None else (packet,)

    def synchronized(self, now: Nanoseconds) -> None:
        """Learn that a SYNC leaves now: the next sample was taken then."""
        self._feedback.synchronized(now)

    def rewritten(self, what: str, now: Nanoseconds) -> None:
        """Note a foreign write to its objects."""
        self._tasks.rewritten(what, now)
        self.wake_at = self._scripts.wake_at

    def request(self, request: ObjectRequest, now: Nanoseconds) -> tuple[Packet, ...]:
        """Read or write an object behind those that wait; dropped while tasks are under way."""
        if self._life.tasks:
            request.over = True
            return ()
        self._requests.append(request)
        return self._waiting(self._next_request(now))

    def receive(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet of this drive; one that makes no sense is ignored."""
        if packet.address == self._answers:
            sent = self._client.receive(packet.payload, now) + self._scripts.go_on(now)
            return self._went_on(sent, now)
        self._feedback.receive(packet.address, packet.payload, now)
        return self._waiting(self._tasks.proceed(now)) if self._life.tasks else ()

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._went_on(self._scripts.wake(now), now)

    def _went_on(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        # Taken only without tasks: during them the outcome is the script's.
        outcome = None if self._life.tasks else self._scripts.take()
        if outcome is not None and self._requests:
            self._requests.popleft().end(outcome, now)
            sent += self._next_request(now)
        return self._waiting(self._tasks.go_on(sent, now))

    def _drop_requests(self) -> None:
        for request in self._requests:
            request.over = True
        self._requests.clear()

    def _next_request(self, now: Nanoseconds) -> tuple[Packet, ...]:
        if not self._requests or not self._scripts.idle:
            return ()
        return self._scripts.ask(self._requests[0].transfer, now)

    def _waiting(self, sent: tuple[Packet, ...]) -> tuple[Packet, ...]:
        """Pass on what is to be sent, once it is known how long to wait for what comes of it."""
        self.wake_at = self._scripts.wake_at
        return sent


def _braking_bounds(axis: Axis) -> tuple[int, int] | None:
    """Return least and largest quick stop deceleration in the drive's units; None where it stays as it is."""
    profile = DriveAxis.of(axis).profile
    if profile.quick_stop_least_rpm_s is None:
        return None
    return in_units(axis, profile.quick_stop_least_rpm_s), in_units(axis, profile.quick_stop_rpm_s)
