"""One EPOS2 on a serial line, or behind the gateway of the one that is: what it is sent, what it reports.

Set-points are those of the CAN driver, written object by object: the target first, then the controlword that
makes it count. A set-point that has not wholly left when the next one comes is not sent any more.
"""

from collections.abc import Callable
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen_drive.driver.drive import Drive
from firmware_bridge.canopen_drive.driver.feedback import FAULT_STATES
from firmware_bridge.canopen_drive.driver.object_request import ObjectRequest
from firmware_bridge.canopen_drive.driver.process_data import SET_POINT
from firmware_bridge.canopen_drive.driver.set_point import DISABLE_VOLTAGE, ENABLE, NEW_POSITION
from firmware_bridge.canopen_drive.driver.tasks import NEWEST_ERROR
from firmware_bridge.drivers.driver import SetPoint
from firmware_bridge.drivers.life_cycle import Task, Transition
from firmware_bridge.families.epos2.driver.inputs_outputs import outputs_at
from firmware_bridge.families.epos2.driver.product import configuration, product, through_gateway
from firmware_bridge.families.epos2.driver.serial.client import (
    SerialClient,
    outcome_of,
    reading,
    request_for,
    silent,
    value_in,
    writing,
)
from firmware_bridge.families.epos2.driver.serial.exchange import Job, LineExchange, Rank, Result, succeeded
from firmware_bridge.families.epos2.driver.serial.feedback import (
    CURRENT,
    ERROR_REGISTER,
    POSITION,
    STATUSWORD,
    ReadRow,
    SerialFeedback,
)
from firmware_bridge.families.epos2.driver.serial.proof import Proof
from firmware_bridge.families.epos2.maxon.messages import (
    ObjectRead,
    ReadObject,
    Request,
    SendNmtService,
    WriteObject,
)
from firmware_bridge.families.epos2.settings import Epos2Axis, Epos2Link, nodes_on
from firmware_bridge.packet import Packet
from firmware_bridge.robot import AnyRobot, Axis, CommandForm
from firmware_bridge.units import MILLISECOND, Nanoseconds

TARGET: Final = {CommandForm.SPEED: od.TARGET_VELOCITY, CommandForm.POSITION: od.TARGET_POSITION}
_NEWEST_ERROR: Final = ReadRow(NEWEST_ERROR, DataType.UNSIGNED32, "newest error")
RECEIVED_BEATS: Final = 3
"""Heartbeats after which a drive has begun to watch; it does so at the first that it receives (CiA 301)."""
NOTICED_CYCLES: Final = 4
"""So many cycles after its watch has ended at the latest a drive's fault is read."""


class Epos2OnSerial(Drive[SerialFeedback]):
    """One drive; a `firmware_bridge.drivers.driver.Driver`."""

    __slots__ = ("_exchange", "_proof", "_reset", "_taken", "_watch", "_writes", "present")

    def __init__(self, axis: Axis, robot: AnyRobot, exchange: LineExchange) -> None:
        """Take the axis, its robot, and the line."""
        self.present = False
        """True where its last answer came; a drive without one is not queried in every cycle."""
        self._exchange = exchange
        link = Epos2Link.of_link(robot, axis.link)
        traffic = through_gateway(axis, link, nodes_on(robot, axis.link))
        feedback = SerialFeedback(axis, product(axis))
        self._proof = Proof(
            axis,
            feedback,
            traffic.watched,
            speaks_for=RECEIVED_BEATS * link.bridge_heartbeat_ms * MILLISECOND,
            within=link.bridge_silent_ms * MILLISECOND + NOTICED_CYCLES * link.every * robot.cycle,
        )
        rows = configuration(axis, link, outputs_at(robot, axis), traffic)
        self._watch = next(row for row in rows if row.address == od.CONSUMER_HEARTBEAT_1)
        """The part of its set-up that is in memory alone: a restart loses it."""
        super().__init__(
            axis,
            feedback,
            SerialClient(Epos2Axis.of(axis).node, exchange, self._note),
            rows,
            started=self._proof.script,
        )
        self._writes: Job | None = None
        """The newest set-point."""
        self._reset: Job | None = None
        """The newest reset."""
        self._taken: dict[Address, int] = {}
        """Controlword and target as the drive has taken them."""

    @property
    def guarded(self) -> bool:
        """True where it answers node guarding: it is there, and its own heartbeat has been switched off."""
        return self.present and self._tasks.set_up

    @property
    def listens(self) -> bool:
        """True while nothing may be sent to it: it shall notice the bridge's silence."""
        return self.busy and self._proof.listens

    @property
    def wake_at(self) -> Nanoseconds:
        """Time of its next wake-up."""
        return self._scripts.wake_at

    def begin(self, transition: Transition, now: Nanoseconds, task: Task | None = None) -> tuple[Packet, ...]:
        """Begin a transition, or that one of its tasks, in place of what is under way."""
        # It may have restarted since, and its target with it.
        self._taken.clear()
        return self._sent(self._tasks.begin(transition, now, task))

    def set_zero(self, position: float, now: Nanoseconds) -> tuple[Packet, ...]:
        """Have it count from this position, in the axis's unit, where it stands."""
        self._taken.clear()
        return self._sent(self._tasks.set_zero(position, now))

    def command(self, set_point: SetPoint) -> tuple[Packet, ...]:
        """Send a set-point; while tasks are under way only what stops.

        Those end the tasks, unless they stop the drive themselves.
        """
        meant = self._tasks.lets(set_point)
        if meant is None:
            return ()
        self._forget_unsent()
        return self._sent((self._set_point.frame_for(meant),))

    def release(self) -> tuple[Packet, ...]:
        """End the handshake of a new position, where one is open."""
        if self.busy or (self._writes is not None and not self._writes.over):
            return ()
        packet = self._set_point.release()
        return () if packet is None else self._sent((packet,))

    def synchronized(self, now: Nanoseconds) -> None:
        """Begin a cycle: what is read from now on makes a new sample."""
        self._feedback.begin(now)

    def read(self, row: ReadRow, rank: Rank) -> Job:
        """Ask for an object."""
        job = Job(rank, self, (reading(Epos2Axis.of(self._axis).node, row.address),))
        self._exchange.put(job)
        return job

    def request(self, request: ObjectRequest, now: Nanoseconds) -> tuple[Packet, ...]:
        """Read an object when the line has time, or write one; dropped where the drive does not answer."""
        if self.present:
            rank = Rank.ROTATING if request.transfer.raw is None else Rank.TASK
            commands = (request_for(Epos2Axis.of(self._axis).node, request.transfer),)
            self._exchange.put(Job(rank, _Requested(request, self._note, now), commands))
        else:
            request.over = True
        return self._exchange.go_on()

    def proceed(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Go on with what the newest answer has made possible; it has come by `ended`."""
        return self._sent(self._tasks.proceed(now))

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._sent(self._tasks.go_on(self._scripts.wake(now), now))

    def lose(self, now: Nanoseconds) -> None:
        """Note that the line is gone: the set-up counts no longer, since it may have been changed."""
        self.present = self._tasks.set_up = False
        self._taken.clear()
        self._feedback.lose()
        self._tasks.fail("the serial line is gone", now)

    def ended(self, job: Job, request: Request, result: Result, now: Nanoseconds) -> None:
        """Take the answer to a set-point, a network command, or an object request."""
        self._note(result)
        if not succeeded(result):
            if job is self._writes:
                self._forget()
        elif isinstance(request, WriteObject):
            address = Address(request.index, request.subindex)
            self._taken[address] = int.from_bytes(request.raw, "little")
        elif isinstance(request, ReadObject) and isinstance(result, ObjectRead):
            self._receive(Address(request.index, request.subindex), result, now)

    def _note(self, result: Result) -> None:
        # Silence is judged by each command: a drive that answers once counts as present again.
        was, self.present = self.present, not silent(result)
        if self.present and not was and self._tasks.set_up:
            # It was silent: it may have restarted, and no boot-up message comes over a line.
            self._tasks.doubted = True
            self.read(ReadRow(self._watch.address, DataType.UNSIGNED32, "watch"), Rank.SAMPLE)
        if not self.present:
            # Each of them would hold up the line for the gateway's time-out once more.
            self._exchange.drop_reads(self)

    def _receive(self, address: Address, result: ObjectRead, now: Nanoseconds) -> None:
        raw, feedback = value_in(address, result), self._feedback
        if address == POSITION.address:
            feedback.position_read(POSITION.type.decode(raw), self._exchange.requested_at)
        elif address == STATUSWORD.address:
            feedback.statusword_read(STATUSWORD.type.decode(raw), now)
            self._forget_reset()
            # There is no EMCY on the line: the code is read from 0x1003:01 when the state shows a fault.
            if feedback.state in FAULT_STATES and not feedback.fault:
                self.read(_NEWEST_ERROR, Rank.SAMPLE)
        elif address == CURRENT.address:
            feedback.current, feedback.current_at = CURRENT.type.decode(raw), now
        elif address == ERROR_REGISTER.address and raw != b"\0" and not feedback.fault and not self.busy:
            self.read(_NEWEST_ERROR, Rank.ROTATING)
        elif address == self._watch.address:
            self._tasks.judge(kept=raw == self._watch.raw)
        elif address == NEWEST_ERROR:
            # The low word of 0x1003:01 is the error code, the high word is the maker's.
            feedback.fault = int.from_bytes(raw[:2], "little")

    def _sent(self, frames: tuple[Packet, ...]) -> tuple[Packet, ...]:
        """Turn what the CAN driver would send into jobs."""
        node = Epos2Axis.of(self._axis).node
        for frame in frames:
            if frame.address == cia301.NMT:
                job = Job(Rank.TASK, self, (SendNmtService(node, frame.payload[0]),))
                if frame.payload[0] == NmtCommand.RESET_NODE:
                    self._reset = job
                self._exchange.put(job)
            else:
                self._write(frame.payload)
        return self._exchange.go_on()

    def _write(self, frame: bytes) -> None:
        """Write the target, where it counts, and the Controlword: first where that disables the power."""
        axis, taken = self._axis, self._taken
        word, target = SET_POINT[axis.command].unpack(frame)
        address = TARGET[axis.command]
        raw = target.to_bytes(4, "little", signed=True)
        writes: list[Request] = []
        if axis.command is CommandForm.SPEED or taken.get(address) != int.from_bytes(raw, "little"):
            writes.append(writing(Epos2Axis.of(axis).node, address, raw))
        if word == NEW_POSITION and taken.get(od.CONTROLWORD, NEW_POSITION) == NEW_POSITION:
            # The drive takes a position at the bit's rising edge, and the bit may be set.
            writes.append(self._word(ENABLE))
        # An answer that does not come keeps the line for long.
        # Power off goes first; everything else needs its target before the Controlword that makes it count.
        writes.insert(0 if word == DISABLE_VOLTAGE else len(writes), self._word(word))
        self._writes = Job(Rank.SET_POINT, self, tuple(writes))
        self._exchange.put(self._writes)

    def _word(self, controlword: int) -> WriteObject:
        return writing(Epos2Axis.of(self._axis).node, od.CONTROLWORD, DataType.UNSIGNED16.encode(controlword))

    def _forget_unsent(self) -> None:
        """Drop what has not left of the newest set-point; what the drive holds then is not known."""
        writes = self._writes
        if writes is not None and not writes.over:
            self._exchange.drop(writes)
            self._forget()

    def _forget_reset(self) -> None:
        """Drop a reset that waits for the line where the power is off: it would only take the reference."""
        reset = self._reset
        if reset is not None and not reset.begun and self._feedback.unpowered:
            self._exchange.drop(reset)
            self._reset = None

    def _forget(self) -> None:
        self._taken.clear()
        # The open handshake is closed here, too: what the drive has taken is not known.
        self._set_point.word(DISABLE_VOLTAGE)


class _Requested:
    """An owner that ends a request when its command has ended."""

    __slots__ = ("_note", "_request", "_requested_at")

    def __init__(self, request: ObjectRequest, note: Callable[[Result], None], now: Nanoseconds) -> None:
        self._request = request
        self._note = note
        self._requested_at = now

    def ended(self, _job: Job, _request: Request, result: Result, now: Nanoseconds) -> None:
        """Take how the command ended."""
        self._note(result)
        self._request.end(outcome_of(self._request.transfer, result, now - self._requested_at), now)
