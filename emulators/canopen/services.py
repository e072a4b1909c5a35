"""The CANopen services of one device: which identifiers count in a network state, and what their frames do.

Source: CiA 301 v4.02. Not known here: how the device starts and by which command its state changes.
"""

from collections.abc import Callable
from functools import partial
from typing import Final

from emulators.canopen.application import Application
from emulators.canopen.broadcasts import Broadcasts
from emulators.canopen.bus_errors import REPORTS, BusError, errors_in
from emulators.canopen.emergency_producer import EmergencyProducer
from emulators.canopen.heartbeat import ErrorControl
from emulators.canopen.identity import Identity
from emulators.canopen.nmt import SERVICES, NodeService
from emulators.canopen.object_store import ObjectStore
from emulators.canopen.process_data import FrameHandler, ProcessData, ReceivePdo, TransmitPdo
from emulators.canopen.product import Product
from emulators.canopen.sdo_server import SdoServer
from emulators.canopen.transmit_queue import TransmitQueue
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import NmtState
from firmware_bridge.units import Nanoseconds
from firmware_bridge.wire.can import REMOTE


class Services:
    """SDO server, PDOs, SYNC, TIME, emergency and error control, with the application behind them."""

    def __init__(
        self,
        store: ObjectStore,
        product: Product,
        identity: Identity,
        transmit: TransmitQueue,
        application: Application,
        *,
        send: Callable[[int, bytes], None],
        synchronize: Callable[[Nanoseconds], None],
    ) -> None:
        """`send` puts a frame on the bus; `synchronize` takes the time of each SYNC."""
        self._product = product
        self._application = application
        self._synchronize = synchronize
        self._identity = identity
        self._transmit = transmit
        self._send = send
        self.state = NmtState.BOOT_UP
        """The network state."""
        self.emergency: Final = EmergencyProducer(store, product)
        self._sdo = SdoServer(store)
        self.broadcasts: Final = Broadcasts(store)
        self.errors: Final = ErrorControl(store, toggles=product.heartbeat_toggles)
        self.pdo: Final = ProcessData(store, product, lambda: self.state)

    @property
    def due(self) -> Nanoseconds:
        """Next time at which a service has to send or to check, independent of the bus."""
        return min(self.errors.due, self.pdo.due, self._transmit.answer_due)

    def enter(self, state: NmtState) -> None:
        """Let the services live that live in this state, and no others."""
        before, self.state = self.state, state
        if NodeService.SDO not in SERVICES[state]:
            self._sdo.reset()
            self._transmit.drop_answers()
        self._application.nmt_changed(state is NmtState.OPERATIONAL)
        # A start command in Operational is no transition: PDOs of type 255 are not sent a second time.
        if before is not state:
            if state is NmtState.OPERATIONAL:
                self.pdo.begin()
            else:
                self.pdo.rest()

    def begin(self, now: Nanoseconds) -> None:
        """Send the boot-up message, and start error control with the objects' values."""
        self._send(cia301.ERROR_CONTROL + self._identity.node, cia301.encode_heartbeat(NmtState.BOOT_UP))
        self.errors.begin(now)

    def speak(self, now: Nanoseconds) -> bool:
        """Send what is due or has changed; say whether other identifiers count from here on."""
        errors, pdo, transmit = self.errors, self.pdo, self._transmit
        if transmit.answer_due <= now:
            for answer in transmit.released(now):
                self._send(cia301.SDO_RESPONSE + self._identity.node, answer)
        if errors.producer.due <= now:
            heartbeat = errors.producer.produce(self.state, now)
            self._send(cia301.ERROR_CONTROL + self._identity.node, heartbeat)
        # Not `or`: each must be called, or a change in error control would wait for the next time.
        others = pdo.renew() | errors.renew() | self.broadcasts.renew()
        if self.state is NmtState.OPERATIONAL:
            for address, payload in pdo.changes(now):
                self._send(address, payload)
        return others

    def routes(self) -> dict[int, FrameHandler]:
        """Return the identifiers that count in this state, with their handlers."""
        services, node = SERVICES[self.state], self._identity.node
        routes: dict[int, FrameHandler] = {}
        if NodeService.PDO in services:
            routes = self.pdo.routes(self._receive_collision, self._receive_request, self._receive_pdo)
        if NodeService.ERROR_CONTROL in services:
            routes[cia301.ERROR_CONTROL + node | REMOTE] = self._receive_guarding
            for watched in sorted(self.errors.watched):
                routes[cia301.ERROR_CONTROL + watched] = partial(self._receive_heartbeat, watched)
        if NodeService.SYNC in services:
            routes[self.broadcasts.sync] = self._receive_sync
        if NodeService.TIME in services and self.broadcasts.time is not None:
            routes[self.broadcasts.time] = self.broadcasts.set_time
        if NodeService.SDO in services:
            routes[cia301.SDO_REQUEST + node] = self._receive_sdo
        return routes | {report: partial(self._receive_controller, report) for report in REPORTS}

    # Service and process data

    def _receive_sdo(self, payload: bytes, now: Nanoseconds) -> None:
        answer = self._sdo.answer(payload)
        if answer is not None:
            self._transmit.answer(answer, now)
        self._application.refresh(now)

    def _receive_pdo(self, sharing: tuple[ReceivePdo, ...], payload: bytes, now: Nanoseconds) -> None:
        for pdo in sharing:
            if pdo.due < now:
                # On a real bus a wake may be late: a message after its time must not hide that it was missed.
                self.watch(now - 1)
            if len(payload) < pdo.size:
                # EMCY 8210: nothing of the frame is taken, also no controlword that was complete.
                self.find(BusError.PDO_TOO_SHORT)
            else:
                pdo.take(payload, now)
        self._application.refresh(now)

    def _receive_sync(self, _payload: bytes, now: Nanoseconds) -> None:
        self._synchronize(now)
        if self.state is NmtState.OPERATIONAL:
            for address, payload in self.pdo.sync():
                self._send(address, payload)
            # Without synchronous receive PDOs a SYNC changes nothing that the axis would have to take in.
            if self.pdo.waits_for_sync:
                self._application.refresh(now)

    def _receive_request(self, pdo: TransmitPdo, _payload: bytes, _now: Nanoseconds) -> None:
        # The answer has the PDO's own length, whatever the request's.
        self._send(pdo.address, pdo.requested())

    def _receive_collision(self, _payload: bytes, _now: Nanoseconds) -> None:
        self.find(BusError.COB_ID_COLLISION)

    # Errors

    def watch(self, until: Nanoseconds) -> None:
        """Check that the other nodes' messages were received in time."""
        if self.errors.lost(until):
            self._application.connection_lost()
        if self.pdo.missed(until):
            self.find(BusError.PDO_MISSED)

    def _receive_heartbeat(self, node: int, payload: bytes, now: Nanoseconds) -> None:
        # On a real bus a wake may be late: a heartbeat after its deadline must not hide the silence.
        self.watch(now - 1)
        self.errors.receive(node, payload, now)

    def _receive_guarding(self, _payload: bytes, now: Nanoseconds) -> None:
        if not self.errors.producer.active:
            self.watch(now - 1)
            answer = self.errors.guard.answer(self.state, now)
            self._send(cia301.ERROR_CONTROL + self._identity.node, answer)

    def _receive_controller(self, address: int, payload: bytes, _now: Nanoseconds) -> None:
        for error in errors_in(address, payload):
            self.find(error)

    def find(self, error: BusError) -> None:
        """Let the application react to an error of the bus side, where the product reports it."""
        code = self._product.bus_errors.get(error)
        if code is not None:
            self._application.communication_fault(code)

    def report(self, code: int) -> None:
        """Record an error of the application, or with code 0 the end of all, and send it on the bus."""
        message = self.emergency.message(code)
        address = self.emergency.cob_id
        # CiA 301: no emergency is sent in Stopped; the error is in register and history all the same.
        allowed = NodeService.EMERGENCY in SERVICES[self.state]
        if message is not None and address is not None and allowed:
            self._send(address, message)
