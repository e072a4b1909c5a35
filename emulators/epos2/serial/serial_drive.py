"""An EPOS2 with a host on its serial port, beside the CAN bus: both see the same objects and the same state.

Other drives of a bus need no port of their own: the gateway reaches them.
"""

from typing import Final

from emulators.canopen.saved_parameters import Storage
from emulators.epos2.canopen.motion_protocol import MotionFactory
from emulators.epos2.control.motion_control import MotionControl
from emulators.epos2.drive import Epos2
from emulators.epos2.objects.device_profile import BAUDS, EPOS2_70_10, DeviceProfile
from emulators.epos2.serial.can_gateway import DriveOnBus
from emulators.epos2.serial.serial_port import SerialPort
from emulators.servo.axis import ServoAxis
from firmware_bridge.canopen.cia301 import NmtCommand, NmtState
from firmware_bridge.families.epos2.maxon.frame import Generation
from firmware_bridge.node import SERIAL
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.units import Nanoseconds


class SerialEpos2(Epos2):
    """One drive on the links "can" and "serial"."""

    def __init__(
        self,
        node_id: int,
        axis: ServoAxis,
        profile: DeviceProfile = EPOS2_70_10,
        motion: MotionFactory = MotionControl,
        *,
        generation: Generation | None = Generation.V1,
        storage: Storage | None = None,
        bus_rate: int | None = None,
    ) -> None:
        """Give the drive a port, V1 on RS232, V2 on USB, None as the host speaks; the rest as in `Epos2`."""
        super().__init__(node_id, axis, profile, motion, storage=storage, bus_rate=bus_rate)
        drive = DriveOnBus(lambda: self.node_id, super()._send, self._overhear, self._written)
        self._port: Final = SerialPort(self.store, profile, generation, drive)

    @property
    def baud(self) -> int:
        """Bit rate on the serial line."""
        return self._port.baud

    def listens(self, packet: Packet) -> bool:
        """Return whether drive or host take this packet now."""
        return packet.link == SERIAL or super().listens(packet) or self._port.listens(packet.address)

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Take one frame of the bus, or bytes of the serial line."""
        if packet.link == SERIAL:
            return self._receive_bytes(packet.payload, now) if self._powered else self.wake(now)
        if not self._powered or not self._port.listens(packet.address):
            return super().receive(packet, now)
        reaction = super().receive(packet, now)
        self._now = now
        self._port.receive_frame(packet.address, packet.payload, now)
        more = self._settle()
        return Reaction(reaction.sent + more.sent, more.wake_at)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Do what is due; the first call switches the drive on."""
        if self._powered:
            self._now = now
            self.motion.refresh(now)
            self._port.wake(now)
        return super().wake(now)

    def _receive_bytes(self, chunk: bytes, now: Nanoseconds) -> Reaction:
        self._now = now
        self.motion.refresh(now)
        if self.nmt_state is not NmtState.BOOT_UP:  # receives nothing until it has started
            self._port.receive(chunk, now)
        return self._settle()

    def _settle(self) -> Reaction:
        reaction = super()._settle()
        sent = self._port.taken()
        wake_at = min(reaction.wake_at, self._port.due)
        if wake_at != reaction.wake_at:
            # The cached reaction must not wake the drive later than its port needs.
            self._transmit.idle = Reaction((), wake_at)
        if not sent:
            return Reaction(reaction.sent, wake_at)
        return Reaction((*reaction.sent, Packet(SERIAL, 0, sent)), wake_at)

    def _send(self, address: int, payload: bytes) -> None:
        super()._send(address, payload)
        if self._port.listens(address):  # the host reads this drive's own frames, too
            self._port.receive_frame(address, payload, self._now)

    def _boot(self, command: NmtCommand) -> None:
        super()._boot(command)
        if command is NmtCommand.RESET_NODE:
            self._port.restart(self._now)

    def _overhear(self, address: int, payload: bytes) -> None:
        handle = self._routes.get(address)
        if handle is not None:
            handle(payload, self._now)

    def _written(self) -> None:
        self.motion.refresh(self._now)
        # A new heartbeat to watch is a new identifier.
        self._route()


def baud_of(drive: Epos2) -> int:
    """Return the rate of a drive's serial line in bits a second; the default of RS232 where it has none."""
    return drive.baud if isinstance(drive, SerialEpos2) else BAUDS[-1]
