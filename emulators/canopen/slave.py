"""One CANopen slave: the node that starts, follows network commands and lets its services work.

Source: CiA 301 v4.02, network management. Not known here: what the services do, what the application does,
and who carries its frames. It ignores every frame that no service of its number takes in the present state:
extended identifiers, remote requests to identifiers that have none.
"""

from datetime import datetime
from typing import Final

from emulators.canopen.application import Application
from emulators.canopen.bus_errors import BusError
from emulators.canopen.identity import Identity
from emulators.canopen.lss_slave import LssSlave
from emulators.canopen.nmt import SERVICES, TARGETS, NodeService, command_for
from emulators.canopen.object_store import ObjectStore
from emulators.canopen.product import Product
from emulators.canopen.saved_parameters import SavedParameters, Storage
from emulators.canopen.services import Services
from emulators.canopen.transmit_queue import TransmitQueue
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds


class CanopenSlave:
    """One device on a CAN bus, of any product."""

    def __init__(
        self,
        hardware_node: int,
        store: ObjectStore,
        product: Product,
        application: Application,
        *,
        storage: Storage,
        bus_rate: int | None,
    ) -> None:
        """Attach the services to the store, whose other hooks come first.

        `hardware_node` is the number that a switch gives; with 0 the saved number counts. `storage` keeps
        saved parameters; at another bit rate than `bus_rate`, in bits a second, the device is off the bus.
        """
        self.store: Final = store
        self._product: Final = product
        self._application: Final = application
        self._identity: Final = Identity(hardware_node, bus_rate, product.layer_setting)
        self._now: Nanoseconds = 0
        self._boot_due: Nanoseconds = NEVER
        self._powered = False
        self._transmit: Final = TransmitQueue(self._identity, product.sdo_latency)
        self._memory: Final = SavedParameters(store, product, storage)
        self._lss: Final = LssSlave(
            store, self._memory, product.layer_setting, lambda: self.node_id, self._switch_rate
        )
        self._services: Final = Services(
            store,
            product,
            self._identity,
            self._transmit,
            application,
            send=self._send,
            synchronize=self.synchronize,
        )
        self._routes = self._services.routes()

    def hang(self, *, hung: bool) -> None:
        """Let its application take no command any more, or take them again: a fault."""
        self._application.hung = hung

    @property
    def node_id(self) -> int:
        """The number in use."""
        return self._identity.node

    @property
    def on_bus(self) -> bool:
        """True if its bit rate allows it to receive from the bus and to be received."""
        return self._identity.on_bus

    @property
    def nmt_state(self) -> NmtState:
        """The network state."""
        return self._services.state

    # The seam

    def listens(self, packet: Packet) -> bool:
        """Return whether some service takes this frame now; the first one of all switches the device on."""
        return packet.address in self._routes or not self._powered

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take one frame of the bus."""
        if not self._powered:
            return self.wake(now)
        handle = self._routes.get(packet.address)
        if handle is None:
            return self._transmit.idle
        self._now = now
        # First of all: an answer carries the actual values of this instant, not those of the last ms.
        self._application.refresh(now)
        handle(packet.payload, now)
        return self._settle()

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the device on."""
        self._now = now
        self._application.refresh(now)
        if not self._powered:
            self._powered = True
            self._boot(NmtCommand.RESET_NODE)
        # A bit rate that has changed decides which identifiers are received at all.
        if self._identity.wake(self.store, now):
            self._route()
        if self._boot_due <= now:
            self._come_up()
        self._services.watch(now)
        return self._settle()

    def _settle(self) -> Reaction:
        """Send what is due or has changed, and say when to come back."""
        if self._services.speak(self._now):
            self._route()
        return self._transmit.reaction(self._due())

    def _due(self) -> Nanoseconds:
        """Return when something is due next, whatever the bus brings."""
        due = min(self._services.due, self._identity.due)
        due = min(due, self._boot_due)
        return min(due, self._application.wake_at())

    def _send(self, address: int, payload: bytes) -> None:
        self._transmit.send(address, payload)

    def _route(self) -> None:
        """Set the identifiers that count in this state, and their receivers."""
        if not self._identity.on_bus:
            self._routes = {}
            return
        self._routes = self._services.routes()
        services = SERVICES[self.nmt_state]
        if NodeService.ERROR_CONTROL in services:
            self._routes[cia301.NMT] = self._receive_command
        if NodeService.LAYER_SETTING in services:
            self._routes[cia301.LSS_REQUEST] = self._receive_lss

    def switch_off(self) -> None:
        """Switch off the supply, logic included: nothing is reported.

        The next packet or waking switches the device on again; the caller keeps them away while the supply is
        cut.
        """
        self._powered = False
        self._application.reset()

    def report(self, code: int) -> None:
        """Record an error of the application, or with code 0 the end of all, and send it on the bus."""
        self._services.report(code)

    def time_of_day(self, now: Nanoseconds) -> datetime | None:
        """Return the time of day that TIME has given; None before the first."""
        return self._services.broadcasts.time_of_day(now)

    def synchronize(self, now: Nanoseconds) -> None:
        """Take the time of a SYNC; a product that keeps it overrides this."""

    # Network management

    def _boot(self, command: NmtCommand) -> None:
        """Power-on and both resets: silence until the boot-up message."""
        services = self._services
        services.errors.rest()
        # No service exists in boot-up: nothing is sent while the objects take their values of power-on.
        self._enter(NmtState.BOOT_UP)
        self._lss.rest()
        if command is NmtCommand.RESET_NODE:
            self._identity.restart(self.store, self._memory, self._lss)
            services.emergency.reset()
            services.broadcasts.forget()
            self._application.reset()
        else:
            # Reset communication concerns 0x1000 to 0x1FFF (CiA 301): the application goes on as it does.
            self._identity.reset_communication(self.store, self._lss)
            self._memory.load_communication()
            services.emergency.communication_reset()
            self._application.communication_reset()
        services.pdo.touch_all()
        self._boot_due = self._now + self._product.boot_time
        if self._boot_due <= self._now:
            self._come_up()

    def _come_up(self) -> None:
        self._boot_due = NEVER
        # The boot-up message comes first on the bus; emergencies are permitted from Pre-Operational on.
        self._services.begin(self._now)
        self._enter(NmtState.PRE_OPERATIONAL)
        # Found while booting, when no emergency may be sent: reported now.
        if self._memory.lost:
            self._memory.lost = False
            self._services.find(BusError.PARAMETERS_LOST)

    def _enter(self, state: NmtState) -> None:
        self._services.enter(state)
        self._route()

    def _receive_command(self, payload: bytes, _now: Nanoseconds) -> None:
        command = command_for(self.node_id, payload)
        if command is None:
            return
        state = TARGETS.get(command)
        if state is None:
            self._boot(command)
        else:
            self._enter(state)

    # Layer setting

    def _receive_lss(self, payload: bytes, _now: Nanoseconds) -> None:
        answer = self._lss.answer(payload)
        if answer is not None:
            self._send(cia301.LSS_RESPONSE, answer)

    def _switch_rate(self, code: int, delay: Nanoseconds) -> None:
        self._identity.switch(code, delay, self._now)
        # A switch delay of 0 ms is over already.
        self._identity.wake(self.store, self._now)
        self._route()
