"""One EPOS2 on a serial line, or behind the gateway of the one that is: what it is told, what it told.

Set-points are those of the CAN driver, written object by object: the target first, then the controlword that
makes it count. A set-point that has not wholly left when the next one comes is not sent any more.
"""

from typing import Final

from firmware_bridge.drivers.drive import Demand, Heard, StartupError, Stop, Task
from firmware_bridge.drivers.epos2_agenda import Agenda
from firmware_bridge.drivers.epos2_pdo import SET_POINT
from firmware_bridge.drivers.epos2_setpoint import DISABLE_VOLTAGE, ENABLE, NEW_POSITION, set_point
from firmware_bridge.drivers.epos2_setup import Travel, configuration, over_serial
from firmware_bridge.drivers.epos2_tasks import NEWEST_ERROR
from firmware_bridge.drivers.script import Performer
from firmware_bridge.drivers.serial.client import SerialClient, reading, silent, value_in, writing
from firmware_bridge.drivers.serial.errands import Errand, Exchange, Rank, Result, succeeded
from firmware_bridge.drivers.serial.heard import FAULT_STATES, SerialEar
from firmware_bridge.drivers.serial.proof import Proof
from firmware_bridge.drivers.serial.rows import CURRENT, ERROR_REGISTER, POSITION, STATUSWORD, ReadRow
from firmware_bridge.node import MAXON
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Mode, Robot
from firmware_bridge.units import MILLISECOND, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.epos2 import address as at
from firmware_bridge.wire.epos2.address import Address
from firmware_bridge.wire.epos2.rows import DataType
from firmware_bridge.wire.maxon.messages import ObjectRead, ReadObject, Request, SendNmtService, WriteObject

TARGET: Final = {Mode.VELOCITY: at.TARGET_VELOCITY, Mode.POSITION: at.TARGET_POSITION}
_NEWEST_ERROR: Final = ReadRow(NEWEST_ERROR, DataType.UNSIGNED32, "newest error")
HEARD_BEATS: Final = 3
"""After so many beats a drive has begun to watch; it does so at the first that it hears (CiA 301)."""
NOTICED_CYCLES: Final = 4
"""So many cycles after its watch has ended at the latest a drive's fault is read."""
_ANALOGUE: Final = (at.ANALOGUE_INPUT_1, at.ANALOGUE_INPUT_2)


class EposSerial:
    """One drive; a `firmware_bridge.drivers.drive.Drive`."""

    __slots__ = (
        "_agenda",
        "_axis",
        "_client",
        "_ear",
        "_exchange",
        "_performer",
        "_proof",
        "_set_point",
        "_told",
        "_writes",
        "present",
    )

    def __init__(self, axis: Axis, robot: Robot, travel: Travel | None, exchange: Exchange) -> None:
        """Take the axis, its robot, the mechanical range of a position axis, and the line."""
        self.present = False
        """Whether it answered last; one that does not is not asked in every cycle."""
        self._axis = axis
        self._exchange = exchange
        self._ear = SerialEar(axis)
        self._set_point = set_point(axis, self._ear.heard, travel)
        self._client = SerialClient(axis.node, exchange, self._note)
        self._performer = Performer(self._client)
        traffic = over_serial(axis, robot)
        rows = configuration(axis, robot.bus, travel, traffic)
        bus = robot.bus
        self._proof = Proof(
            axis,
            self._ear,
            traffic.watched,
            heard=HEARD_BEATS * bus.bridge_heartbeat_ms * MILLISECOND,
            within=(bus.bridge_silent_ms + NOTICED_CYCLES * bus.cycle_ms) * MILLISECOND,
        )
        self._agenda = Agenda(
            axis, self._ear, self._set_point, self._performer, rows, started=self._proof.script
        )
        self._writes: Errand | None = None
        """The newest set-point."""
        self._told: dict[Address, int] = {}
        """Controlword and target as the drive has taken them."""

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""
        return self._axis

    @property
    def heard(self) -> Heard:
        """What it has told."""
        return self._ear.heard

    @property
    def busy(self) -> bool:
        """Whether tasks are under way."""
        return self._agenda.busy

    @property
    def failure(self) -> StartupError | None:
        """Why the last tasks failed; None where they did not."""
        return self._agenda.failure

    @property
    def configured(self) -> bool:
        """Whether its set-up is in force and it listens to set-points."""
        return self._agenda.configured

    @property
    def guarded(self) -> bool:
        """Whether it answers node guarding: it is there, and its own heartbeat has been switched off."""
        return self.present and self._agenda.set_up

    @property
    def listens(self) -> bool:
        """Whether it waits to be told nothing: it shall notice the bridge's silence."""
        return self.busy and self._proof.listens

    @property
    def wake_at(self) -> Nanoseconds:
        """When it wants to be woken."""
        return self._performer.wake_at

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Do these tasks in order, in place of those under way."""
        # It may have restarted since, and its target with it.
        self._told.clear()
        return self._sent(self._agenda.begin(tasks, now))

    def command(self, demand: Demand) -> tuple[Packet, ...]:
        """Send a demand; while tasks are under way only one that ends them: quick stop or power off."""
        if self.busy:
            if demand not in (Stop.QUICK_STOP, Stop.POWER_OFF):
                return ()
            self._agenda.end()
        self._forget_unsent()
        return self._sent((self._set_point.demand(demand),))

    def release(self) -> tuple[Packet, ...]:
        """End the handshake of a new position, where one is open."""
        if self.busy or (self._writes is not None and not self._writes.over):
            return ()
        packet = self._set_point.release()
        return () if packet is None else self._sent((packet,))

    def synchronised(self, now: Nanoseconds) -> None:
        """Begin a cycle: what is read from now on makes a new sample."""
        self._ear.begin(now)

    def read(self, row: ReadRow, rank: Rank) -> Errand:
        """Ask for an object."""
        errand = Errand(rank, self, (reading(self._axis.node, row.address),))
        self._exchange.put(errand)
        return errand

    def measure(self, analogue_input: int, _now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask for an analogue input in mV (0x207C, EDS); it comes when the line has time."""
        if self.present:
            address = Address(at.ANALOGUE_INPUT_1.index, analogue_input)
            self.read(ReadRow(address, DataType.INTEGER16, "analogue input"), Rank.ROTATING)
        return self._exchange.go_on()

    def look(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Go on with what the newest answer has made possible; it has come by `ended`."""
        return self._sent(self._agenda.look(now))

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._sent(self._agenda.go_on(self._performer.wake(now), now))

    def lose(self, now: Nanoseconds) -> None:
        """Take notice that the line is gone: the set-up counts no longer, somebody may have changed it."""
        self.present = self._agenda.set_up = False
        self._told.clear()
        self._ear.lose()
        self._agenda.fail("the serial line is gone", now)

    def ended(self, errand: Errand, request: Request, result: Result, now: Nanoseconds) -> None:
        """Take the answer to a set-point, a network command, or an object that was asked for."""
        self._note(result)
        if not succeeded(result):
            if errand is self._writes:
                self._forget()
        elif isinstance(request, WriteObject):
            address = Address(request.index, request.subindex)
            self._told[address] = int.from_bytes(request.raw, "little")
        elif isinstance(request, ReadObject) and isinstance(result, ObjectRead):
            self._hear(Address(request.index, request.subindex), result, now)

    def _note(self, result: Result) -> None:
        self.present = not silent(result)

    def _hear(self, address: Address, result: ObjectRead, now: Nanoseconds) -> None:
        raw, heard = value_in(address, result), self.heard
        if address == POSITION.address:
            self._ear.position(POSITION.type.decode(raw), self._exchange.asked_at)
        elif address == STATUSWORD.address:
            self._ear.statusword(STATUSWORD.type.decode(raw), now)
            if heard.state in FAULT_STATES and not heard.fault:
                self.read(_NEWEST_ERROR, Rank.SAMPLE)
        elif address == CURRENT.address:
            heard.current_ma = CURRENT.type.decode(raw)
        elif address == ERROR_REGISTER.address and raw != b"\0" and not heard.fault and not self.busy:
            self.read(_NEWEST_ERROR, Rank.ROTATING)
        elif address == NEWEST_ERROR:
            heard.fault = int.from_bytes(raw[:2], "little")
        elif address in _ANALOGUE:
            heard.analogue_mv = DataType.INTEGER16.decode(raw)

    def _sent(self, packets: tuple[Packet, ...]) -> tuple[Packet, ...]:
        """Turn what the CAN driver would send into errands."""
        node = self._axis.node
        sent: tuple[Packet, ...] = ()
        for packet in packets:
            if packet.link == MAXON:
                sent += (packet,)
            elif packet.address == canopen.NMT:
                self._exchange.put(Errand(Rank.TASK, self, (SendNmtService(node, packet.payload[0]),)))
            else:
                self._write(packet.payload)
        return sent + self._exchange.go_on()

    def _write(self, frame: bytes) -> None:
        """Write a set-point: the target where it counts, and the controlword."""
        axis, told = self._axis, self._told
        word, target = SET_POINT[axis.mode].unpack(frame)
        address = TARGET[axis.mode]
        raw = target.to_bytes(4, "little", signed=True)
        writes: list[Request] = []
        if axis.mode is Mode.VELOCITY or told.get(address) != int.from_bytes(raw, "little"):
            writes.append(writing(axis.node, address, raw))
        if word == NEW_POSITION and told.get(at.CONTROLWORD, NEW_POSITION) == NEW_POSITION:
            # The drive takes a position at the bit's rising edge, and the bit may be set.
            writes.append(self._word(ENABLE))
        writes.append(self._word(word))
        self._writes = Errand(Rank.SET_POINT, self, tuple(writes))
        self._exchange.put(self._writes)

    def _word(self, controlword: int) -> WriteObject:
        return writing(self._axis.node, at.CONTROLWORD, DataType.UNSIGNED16.encode(controlword))

    def _forget_unsent(self) -> None:
        """Drop what has not left of the newest set-point; what the drive holds then is not known."""
        writes = self._writes
        if writes is not None and not writes.over:
            self._exchange.drop(writes)
            self._forget()

    def _forget(self) -> None:
        self._told.clear()
        self._set_point.word(DISABLE_VOLTAGE)
