"""One EPOS2 on CAN as the bridge sees it: its tasks, its set-points, what it told. Bytes and time only."""

from collections import deque
from typing import Final

from firmware_bridge.drivers import epos2_tasks
from firmware_bridge.drivers.drive import Demand, Heard, StartupError, Stop, Task
from firmware_bridge.drivers.epos2_heard import Ear
from firmware_bridge.drivers.epos2_setpoint import set_point
from firmware_bridge.drivers.epos2_setup import Travel
from firmware_bridge.drivers.script import Performer, Script
from firmware_bridge.drivers.sdo_client import SdoError, Transfer
from firmware_bridge.node import Packet
from firmware_bridge.robot import Axis, Bus
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.epos2.address import ANALOGUE_INPUT_1, Address
from firmware_bridge.wire.epos2.rows import DataType

_ANALOGUE: Final = DataType.INTEGER16
_NEEDS_SET_UP: Final = (Task.IDENTIFY, Task.CONFIGURE, Task.START, Task.ENABLE)


class Epos2:
    """One drive; a `firmware_bridge.drivers.drive.Drive`."""

    __slots__ = (
        "_axis",
        "_bus",
        "_configured",
        "_ear",
        "_failure",
        "_performer",
        "_set_point",
        "_task",
        "_tasks",
        "_travel",
    )

    def __init__(self, axis: Axis, bus: Bus, travel: Travel | None = None) -> None:
        """Take the axis, and the mechanical range of a position axis."""
        self._axis = axis
        self._bus = bus
        self._travel = travel
        self._ear = Ear(axis)
        self._set_point = set_point(axis, self._ear.heard, travel)
        self._performer = Performer(axis.node)
        self._tasks: deque[Task] = deque()
        self._task: Task | None = None
        self._failure: StartupError | None = None
        self._configured = False

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
        return self._task is not None

    @property
    def failure(self) -> StartupError | None:
        """Why the last tasks failed; None where they did not."""
        return self._failure

    @property
    def configured(self) -> bool:
        """Whether its set-up is in force and it listens to set-points."""
        return self._configured and self.heard.operational and not self.heard.restarted

    @property
    def wake_at(self) -> Nanoseconds:
        """When it wants to be woken."""
        return self._performer.wake_at

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Do these tasks in order, in place of those under way."""
        self._end()
        self._failure = None
        self._tasks.extend(tasks)
        return self._go_on((), now)

    def command(self, demand: Demand) -> tuple[Packet, ...]:
        """Send a demand; while tasks are under way only one that ends them: quick stop or power off."""
        if self.busy:
            if demand not in (Stop.QUICK_STOP, Stop.POWER_OFF):
                return ()
            self._end()
        return (self._set_point.demand(demand),)

    def release(self) -> tuple[Packet, ...]:
        """End the handshake of a new position, where one is open."""
        packet = None if self.busy else self._set_point.release()
        return () if packet is None else (packet,)

    def synchronised(self, now: Nanoseconds) -> None:
        """Learn that a SYNC leaves now: the next sample was taken then."""
        self._ear.synchronised(now)

    def measure(self, analogue_input: int, now: Nanoseconds) -> tuple[Packet, ...]:
        """Ask for an analogue input in mV when nothing else is under way (0x207C, EDS)."""
        if not self._performer.idle:
            return ()
        address = Address(ANALOGUE_INPUT_1.index, analogue_input)
        return self._performer.ask(Transfer(address, attempts=1), now)

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet of this drive; one that makes no sense is ignored."""
        if packet.address == canopen.SDO_RESPONSE + self._axis.node:
            return self._go_on(self._performer.answered(packet.payload, now), now)
        self._ear.hear(packet.address, packet.payload, now)
        if self._task is None:
            return ()
        if self.heard.restarted and self._task in _NEEDS_SET_UP:
            self._performer.stop(StartupError(self._axis, "it restarted by itself and lost its set-up"))
            return self._go_on((), now)
        return self._go_on(self._performer.go_on(now), now)

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._go_on(self._performer.wake(now), now)

    def _go_on(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Add what the next tasks send, where one has ended."""
        if not self.busy and not self._tasks:
            self._measured()
            return sent
        while not self._performer.busy:
            if self._performer.failure is not None:
                failure = self._performer.failure
                self._end()
                self._failure = failure
                break
            if self._task is Task.CONFIGURE:
                self._configured = True
            self._task = self._tasks.popleft() if self._tasks else None
            if self._task is None:
                break
            sent += self._performer.perform(self._script(self._task), now)
        return sent

    def _script(self, task: Task) -> Script:
        axis, ear = self._axis, self._ear
        match task:
            case Task.FIND:
                self._configured = False
                return epos2_tasks.find(axis, ear)
            case Task.IDENTIFY:
                return epos2_tasks.identify(axis)
            case Task.CONFIGURE:
                return epos2_tasks.configure(axis, self._bus, self._travel)
            case Task.START:
                return epos2_tasks.start(axis, ear)
            case Task.ENABLE:
                return epos2_tasks.enable(axis, ear, self._set_point)
            case Task.LEAVE:
                return epos2_tasks.leave(axis, ear, self._set_point)

    def _end(self) -> None:
        self._performer.stop()
        self._tasks.clear()
        self._task = None

    def _measured(self) -> None:
        outcome = self._performer.take()
        if outcome is None:
            return
        if isinstance(outcome, SdoError) or len(outcome) != _ANALOGUE.size:
            self.heard.analogue_mv = None
        else:
            self.heard.analogue_mv = _ANALOGUE.decode(outcome)
