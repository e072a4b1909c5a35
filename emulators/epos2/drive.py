"""One emulated EPOS2 on a CAN bus: the node that starts, follows network commands and lets its services work.

Source: CiA 301 v4.02, network management. Not known here: what the services do and how a motor moves
(the packages `canopen` and `control` do), and who carries its frames. It ignores every frame that no service
of its number takes in the present state: extended identifiers, remote requests to identifiers that have none.
"""

from functools import partial
from typing import Final

from emulators.epos2.canopen.identity import Identity
from emulators.epos2.canopen.lss_slave import LssSlave
from emulators.epos2.canopen.motion_protocol import MotionFactory
from emulators.epos2.canopen.nmt import SERVICES, TARGETS, NodeService, command_for
from emulators.epos2.canopen.services import Services
from emulators.epos2.canopen.transmit_queue import TransmitQueue
from emulators.epos2.control import value_ranges
from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.objects.device_profile import EPOS2_70_10, DeviceProfile
from emulators.epos2.objects.saved_parameters import SavedParameters, Storage, Volatile
from emulators.epos2.objects.store import ObjectStore
from emulators.servo.axis import STAGE_RISE_MC, ServoAxis
from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.cia301 import LAST_NODE, NmtCommand, NmtState
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import NEVER, Nanoseconds
from firmware_bridge.wire.epos2 import emergency


def _counting(motion: MotionFactory, profile: DeviceProfile) -> MotionFactory:
    """Return the factory of motion control, with the profile's rule for set-points by write."""
    if motion is not MotionControl:
        return motion
    return partial(MotionControl, each_write_counts=profile.written_word_is_setpoint)


class Epos2:
    """One drive. `node_id` is the setting of its DIP switch; with 0 the saved number counts."""

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
            raise ValueError(f"a DIP switch gives a number between 0 and {LAST_NODE}, not {node_id}")
        self.profile: Final = profile
        self._identity = Identity(node_id, bus_rate)
        self.store: Final = ObjectStore(
            self.node_id, profile.differing(node_id), profile.bounds(), profile.objects
        )
        self._now: Nanoseconds = 0
        self._boot_due: Nanoseconds = NEVER
        self._powered = False
        self._transmit = TransmitQueue(self._identity, profile.sdo_latency)
        # Ranges first: hooks run in the order of registration, and none may act on a value out of range.
        value_ranges.keep(self.store)
        self._memory = SavedParameters(self.store, profile, storage or Volatile())
        self._lss = LssSlave(self.store, self._memory, lambda: self.node_id, self._switch_rate)
        axis.over_current_ma, axis.over_voltage_mv = profile.over_current_ma, profile.over_voltage_mv
        # In mA^2 per 1/1000 K: the continuous current heats the stage by STAGE_RISE_MC.
        axis.square_per_mc = profile.continuous_current_ma**2 // STAGE_RISE_MC
        self._services = Services(
            self.store,
            profile,
            self._identity,
            self._transmit,
            send=self._send,
            motion=partial(_counting(motion, profile), self.store, axis),
        )
        self.motion: Final = self._services.motion
        self._routes = self._services.routes()

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
        """Return whether some service takes this frame now; the first one of all switches the drive on."""
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
        self.motion.refresh(now)
        handle(packet.payload, now)
        return self._settle()

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the drive on."""
        self._now = now
        self.motion.refresh(now)
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
        return min(due, self.motion.wake_at())

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
        """Switch off the supply, logic included: nothing is reported, the motor is without power.

        The next packet or waking switches the drive on again; the caller keeps them away while the supply is
        cut.
        """
        self._powered = False
        self.motion.reset()

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
            self.motion.reset()
        else:
            # Reset communication concerns 0x1000 to 0x1FFF (CiA 301): the motor goes on as it does.
            self._identity.reset_communication(self.store, self._lss)
            self._memory.load_communication()
            services.emergency.communication_reset()
            self.motion.communication_reset()
        services.pdo.touch_all()
        self._boot_due = self._now + self.profile.boot_time
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
            self.motion.communication_fault(emergency.INTERNAL_SOFTWARE)

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
