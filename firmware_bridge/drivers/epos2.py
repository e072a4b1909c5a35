"""One EPOS2 on CAN as the bridge sees it: its tasks, its set-points, what it told. Bytes and time only."""

from typing import Final

from firmware_bridge.drivers.drive import Demand, Heard, StartupError, Stop, Task
from firmware_bridge.drivers.epos2_agenda import Agenda
from firmware_bridge.drivers.epos2_heard import Ear
from firmware_bridge.drivers.epos2_setpoint import set_point
from firmware_bridge.drivers.epos2_setup import Travel, configuration
from firmware_bridge.drivers.script import Performer
from firmware_bridge.drivers.sdo_client import NodeClient, SdoError, Transfer
from firmware_bridge.packet import Packet
from firmware_bridge.robot import Axis, Bus
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.epos2.address import ANALOGUE_INPUT_1, Address
from firmware_bridge.wire.epos2.rows import DataType

_ANALOGUE: Final = DataType.INTEGER16


class Epos2:
    """One drive; a `firmware_bridge.drivers.drive.Drive`."""

    __slots__ = (
        "_agenda",
        "_answers",
        "_axis",
        "_client",
        "_ear",
        "_performer",
        "_set_point",
        "heard",
        "wake_at",
    )

    def __init__(self, axis: Axis, bus: Bus, travel: Travel | None = None) -> None:
        """Take the axis, and the mechanical range of a position axis."""
        self._axis = axis
        self._answers: Final = canopen.SDO_RESPONSE + axis.node
        """Where its SDO server answers."""
        self._ear = Ear(axis)
        self.heard: Final[Heard] = self._ear.heard
        """What it has told."""
        self.wake_at: Nanoseconds = NEVER
        """When it wants to be woken. Asked for after every packet, as `heard` is: so they are attributes."""
        self._set_point = set_point(axis, self._ear.heard, travel)
        self._client = NodeClient(axis.node)
        self._performer = Performer(self._client)
        rows = configuration(axis, bus, travel)
        self._agenda = Agenda(axis, self._ear, self._set_point, self._performer, rows)

    @property
    def axis(self) -> Axis:
        """The axis that it moves."""
        return self._axis

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

    def begin(self, tasks: tuple[Task, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        """Do these tasks in order, in place of those under way."""
        return self._waiting(self._agenda.begin(tasks, now))

    def command(self, demand: Demand) -> tuple[Packet, ...]:
        """Send a demand; while tasks are under way only one that ends them: quick stop or power off."""
        if self.busy:
            if demand not in (Stop.QUICK_STOP, Stop.POWER_OFF):
                return ()
            self._agenda.end()
            self.wake_at = self._performer.wake_at
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
        return self._waiting(self._performer.ask(Transfer(address, attempts=1), now))

    def hear(self, packet: Packet, now: Nanoseconds) -> tuple[Packet, ...]:
        """Take a packet of this drive; one that makes no sense is ignored."""
        if packet.address == self._answers:
            sent = self._client.hear(packet.payload, now) + self._performer.go_on(now)
            return self._went_on(sent, now)
        self._ear.hear(packet.address, packet.payload, now)
        return self._waiting(self._agenda.look(now)) if self.busy else ()

    def wake(self, now: Nanoseconds) -> tuple[Packet, ...]:
        """Act on the time."""
        return self._went_on(self._performer.wake(now), now)

    def _went_on(self, sent: tuple[Packet, ...], now: Nanoseconds) -> tuple[Packet, ...]:
        if not self.busy:
            self._measured()
        return self._waiting(self._agenda.go_on(sent, now))

    def _waiting(self, sent: tuple[Packet, ...]) -> tuple[Packet, ...]:
        """Pass on what is to be sent, once it is known how long to wait for what comes of it."""
        self.wake_at = self._performer.wake_at
        return sent

    def _measured(self) -> None:
        outcome = self._performer.take()
        if outcome is None:
            return
        if isinstance(outcome, SdoError) or len(outcome) != _ANALOGUE.size:
            self.heard.analogue_mv = None
        else:
            self.heard.analogue_mv = _ANALOGUE.decode(outcome)
