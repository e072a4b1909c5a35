"""One emulated EPOS2 on a CAN bus: the node that ties services, objects and motion control together.

Source: CiA 301 v4.02 for the services. It refuses to know how a motor moves (`emulators.epos2.motion` does)
and who carries its frames. It ignores every frame that no service of its number takes in the present state:
extended identifiers, remote requests to identifiers that have none.
"""

from collections.abc import Callable
from functools import partial
from typing import Final, TypeAlias

from emulators.epos2 import rules
from emulators.epos2.bus_errors import REPORTS, emergencies_of
from emulators.epos2.clock import HighResolutionClock
from emulators.epos2.contract import MotionFactory
from emulators.epos2.emergency import EmergencyProducer
from emulators.epos2.heartbeat import ErrorControl
from emulators.epos2.identity import Identity
from emulators.epos2.lss import LssSlave
from emulators.epos2.memory import Memory, Storage, Volatile
from emulators.epos2.motion import MotionControl
from emulators.epos2.nmt import SERVICES, TARGETS, Service, command_for
from emulators.epos2.outbox import Outbox
from emulators.epos2.pdo import ReceivePdo, TransmitPdo
from emulators.epos2.process_data import ProcessData
from emulators.epos2.profile import EPOS2_70_10, DeviceProfile
from emulators.epos2.sdo_server import SdoServer
from emulators.epos2.store import ObjectStore
from emulators.servo.axis import STAGE_RISE_MC, ServoAxis
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire import canopen
from firmware_bridge.wire.can import REMOTE
from firmware_bridge.wire.canopen import LAST_NODE, NmtCommand, NmtState
from firmware_bridge.wire.epos2 import emergency

_Heard: TypeAlias = Callable[[bytes], None]


class Epos2:
    """One drive. `node_id` is what its DIP switch says; with 0 the saved number counts."""

    def __init__(
        self,
        node_id: int,
        axis: ServoAxis,
        profile: DeviceProfile = EPOS2_70_10,
        motion: MotionFactory = MotionControl,
        *,
        storage: Storage | None = None,
        bus_rate: int | None = None,
    ) -> None:
        """`storage` keeps saved parameters; at another bit rate than `bus_rate` the drive is off the bus."""
        if not 0 <= node_id <= LAST_NODE:
            raise ValueError(f"a DIP switch says a number between 0 and {LAST_NODE}, not {node_id}")
        self.profile: Final = profile
        self.nmt_state = NmtState.BOOT_UP
        self._identity = Identity(node_id, bus_rate)
        self.store: Final = ObjectStore(self.node_id, profile.differing(node_id), profile.bounds())
        self._now: Nanoseconds = 0
        self._boot_due: Nanoseconds = NEVER
        self._powered = False
        self._outbox = Outbox(self._identity, profile.sdo_latency)
        rules.keep(self.store)
        self._emergency = EmergencyProducer(self.store, tells_cured=profile.tells_cured)
        self._sdo = SdoServer(self.store)
        self._clock = HighResolutionClock(self.store)
        self._errors = ErrorControl(self.store, toggles=profile.heartbeat_toggles)
        self._memory = Memory(self.store, profile, self._restored, storage or Volatile())
        self._lss = LssSlave(self.store, self._memory, lambda: self.node_id, self._switch_rate)
        self._pdo = ProcessData(self.store, profile, lambda: self.nmt_state)
        axis.over_current_ma, axis.over_voltage_mv = profile.over_current_ma, profile.over_voltage_mv
        axis.square_per_mc = profile.continuous_current_ma**2 // STAGE_RISE_MC
        self.motion: Final = motion(self.store, axis, self._report)
        self._routes: dict[int, _Heard] = {}

    @property
    def node_id(self) -> int:
        """The number in use."""
        return self._identity.node

    @property
    def on_bus(self) -> bool:
        """Whether its bit rate lets it hear the bus and be heard."""
        return self._identity.on_bus

    # The seam

    def listens(self, packet: Packet) -> bool:
        """Return whether some service takes this frame now; the first one of all switches the drive on."""
        return packet.address in self._routes or not self._powered

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take one frame of the bus."""
        if not self._powered:
            return self.wake(now)
        heard = self._routes.get(packet.address)
        if heard is None:
            return self._outbox.idle
        self._now = now
        self.motion.refresh(now)
        heard(packet.payload)
        return self._settle()

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the drive on."""
        self._now = now
        self.motion.refresh(now)
        if not self._powered:
            self._powered = True
            self._boot(NmtCommand.RESET_NODE)
        if self._identity.wake(self.store, now):
            self._route()
        if self._boot_due <= now:
            self._come_up()
        self._watch(now)
        return self._settle()

    def _settle(self) -> Reaction:
        """Send what is due or has changed, and say when to come back."""
        now, errors, pdo, outbox = self._now, self._errors, self._pdo, self._outbox
        if outbox.answer_due <= now:
            for answer in outbox.released(now):
                self._send(canopen.SDO_RESPONSE + self.node_id, answer)
        if errors.producer.due <= now:
            self._send(canopen.ERROR_CONTROL + self.node_id, errors.producer.produce(self.nmt_state, now))
        if pdo.renew():
            self._route()
        if self.nmt_state is NmtState.OPERATIONAL:
            for address, payload in pdo.changes(now):
                self._send(address, payload)
        return outbox.reaction(self._due())

    def _due(self) -> Nanoseconds:
        """Return when something is due next, whatever the bus brings."""
        due = min(self._errors.due, self._pdo.due)
        due = min(due, self._outbox.answer_due)
        due = min(due, self._identity.due)
        due = min(due, self._boot_due)
        return min(due, self.motion.wake_at())

    def _send(self, address: int, payload: bytes) -> None:
        self._outbox.send(address, payload)

    # Network management

    def _boot(self, command: NmtCommand) -> None:
        """Power-on and both resets: silence until the boot-up message."""
        self._errors.rest()
        self._enter(NmtState.BOOT_UP)
        self._lss.rest()
        if command is NmtCommand.RESET_NODE:
            self._identity.restart(self.store, self._memory, self._lss)
            self._emergency.reset()
            self.motion.reset()
        else:
            self._identity.reset_communication(self.store, self._lss)
            self._memory.load_communication()
            self._emergency.communication_reset()
            self.motion.communication_reset()
        self._pdo.touch_all()
        self._boot_due = self._now + self.profile.boot_time
        if self._boot_due <= self._now:
            self._come_up()

    def _come_up(self) -> None:
        self._boot_due = NEVER
        self._send(canopen.ERROR_CONTROL + self.node_id, canopen.encode_heartbeat(NmtState.BOOT_UP))
        self._errors.begin(self._now)
        self._enter(NmtState.PRE_OPERATIONAL)
        if self._memory.lost:
            self._memory.lost = False
            self.motion.communication_fault(emergency.INTERNAL_SOFTWARE)

    def _enter(self, state: NmtState) -> None:
        before, self.nmt_state = self.nmt_state, state
        if Service.SDO not in SERVICES[state]:
            self._sdo.reset()
            self._outbox.drop_answers()
        self.motion.nmt_changed(state is NmtState.OPERATIONAL)
        if before is not state:
            if state is NmtState.OPERATIONAL:
                self._pdo.begin()
            else:
                self._pdo.rest()
        self._route()

    def _route(self) -> None:
        """Say which identifiers count in this state, and who hears them."""
        if not self._identity.on_bus:
            self._routes = {}
            return
        services, node = SERVICES[self.nmt_state], self.node_id
        routes: dict[int, _Heard] = {}
        if Service.PDO in services:
            routes = self._pdo.routes(self._hear_collision, self._hear_request, self._hear_pdo)
        if Service.ERROR_CONTROL in services:
            routes[canopen.NMT] = self._hear_command
            routes[canopen.ERROR_CONTROL + node | REMOTE] = self._hear_guarding
            for watched in sorted(self._errors.watched):
                routes[canopen.ERROR_CONTROL + watched] = partial(self._hear_heartbeat, watched)
        if Service.SYNC in services:
            routes[canopen.SYNC] = self._hear_sync
        if Service.SDO in services:
            routes[canopen.SDO_REQUEST + node] = self._hear_sdo
        if Service.LAYER_SETTING in services:
            routes[canopen.LSS_REQUEST] = self._hear_lss
        self._routes = routes | {report: partial(self._hear_controller, report) for report in REPORTS}

    def _hear_command(self, payload: bytes) -> None:
        command = command_for(self.node_id, payload)
        if command is None:
            return
        state = TARGETS.get(command)
        if state is None:
            self._boot(command)
        else:
            self._enter(state)

    def _restored(self) -> None:
        """Every parameter has its default again: all services begin anew with them."""
        self.motion.reset()
        self._errors.begin(self._now)
        self._pdo.touch_all()

    # Service and process data

    def _hear_sdo(self, payload: bytes) -> None:
        watched = self._errors.watched
        answer = self._sdo.answer(payload)
        if answer is not None:
            self._outbox.answer(answer, self._now)
        self.motion.refresh(self._now)
        if self._errors.watched != watched:
            # A new heartbeat to watch is a new identifier.
            self._route()

    def _hear_pdo(self, sharing: tuple[ReceivePdo, ...], payload: bytes) -> None:
        for pdo in sharing:
            if len(payload) < pdo.size:
                self.motion.communication_fault(emergency.PDO_TOO_SHORT)
            else:
                pdo.take(payload)
        self.motion.refresh(self._now)

    def _hear_sync(self, _payload: bytes) -> None:
        self._clock.latch(self._now)
        if self.nmt_state is NmtState.OPERATIONAL:
            for address, payload in self._pdo.sync():
                self._send(address, payload)
            if self._pdo.waits_for_sync:
                self.motion.refresh(self._now)

    def _hear_request(self, pdo: TransmitPdo, _payload: bytes) -> None:
        # The answer has the PDO's own length whatever the request says (recorded from an EPOS2).
        self._send(pdo.address, pdo.requested())

    def _hear_collision(self, _payload: bytes) -> None:
        self.motion.communication_fault(emergency.COB_ID_COLLISION)

    # Layer setting and the controller's reports

    def _hear_lss(self, payload: bytes) -> None:
        answer = self._lss.answer(payload)
        if answer is not None:
            self._send(canopen.LSS_RESPONSE, answer)

    def _switch_rate(self, code: int, delay: Nanoseconds) -> None:
        self._identity.switch(code, delay, self._now)
        self._identity.wake(self.store, self._now)
        self._route()

    def _hear_controller(self, address: int, payload: bytes) -> None:
        for code in emergencies_of(address, payload):
            self.motion.communication_fault(code)

    # Error control

    def _watch(self, until: Nanoseconds) -> None:
        if self._errors.lost(until):
            self.motion.connection_lost()

    def _hear_heartbeat(self, node: int, payload: bytes) -> None:
        # On a real bus a wake may be late: a heartbeat after its deadline must not hide the silence.
        self._watch(self._now - 1)
        self._errors.hear(node, payload, self._now)

    def _hear_guarding(self, _payload: bytes) -> None:
        if not self._errors.producer.active:
            self._watch(self._now - 1)
            answer = self._errors.guard.answer(self.nmt_state, self._now)
            self._send(canopen.ERROR_CONTROL + self.node_id, answer)

    def _report(self, code: int) -> None:
        """Note an error of motion control, or with code 0 the end of all, and tell the bus."""
        message = self._emergency.message(code)
        address = self._emergency.cob_id
        allowed = Service.EMERGENCY in SERVICES[self.nmt_state]
        if message is not None and address is not None and allowed:
            self._send(address, message)
