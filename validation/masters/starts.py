"""The start sequences of masters, step by step, as their sources have them; none of their code is here.

Sources: ros2_canopen with Lely's master (boot and configuration by nmt_boot and nmt_cfg of lely-core, drive
layer by the motor of ros2_canopen), ros_canopen (canopen_master, canopen_402), python-canopen (BaseNode402).
Assumed: ros_canopen keeps bit 30 of a COB-ID, as it has read it; both ROS layers are used in profile velocity
mode, with SYNC every 10 ms and the statusword in transmit PDO 1.
"""

from collections.abc import Callable, Mapping
from typing import Final

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.cia402 import STATES, ControlwordBit, Mode, PowerState, towards, word_of
from validation.masters.bus import NODE, Bus, StartError

PERIOD_MS: Final = 10.0
"""Of the ROS layers: one Controlword in each."""
BOOT_MS: Final = 1_000.0
BOOTS_MS: Final = 10_000.0
STEP_MS: Final = 5_000.0
"""In which a power state, and a mode, must be reached."""
TURNS_RPM: Final = 300
TOLERANCE_RPM: Final = 60
HALT: Final = int(ControlwordBit.HALT)
STATUSWORD_PDO: Final = 0x1800
SYNCHRONOUS: Final = 1


def ros2_canopen(bus: Bus) -> None:
    """Start as ros2_canopen does with Lely's master; StartError."""
    _booted(bus, BOOT_MS)
    # Lely drops bit 30 of an identifier that it chooses itself.
    _configured(bus, keeps_no_remote=False)
    _drive_layer(bus)


def lely(bus: Bus) -> None:
    """Boot and configure as Lely's master alone does, with a configuration by dcfgen; StartError."""
    _booted(bus, BOOTS_MS)
    _configured(bus, keeps_no_remote=False)


def ros_canopen(bus: Bus) -> None:
    """Start as ros_canopen does; StartError."""
    _booted(bus, BOOTS_MS)
    _configured(bus, keeps_no_remote=True)
    _drive_layer(bus)


def python_canopen(bus: Bus) -> None:
    """Start as python-canopen's BaseNode402 does; StartError."""
    bus.waits(BOOTS_MS, lambda: bus.booted)
    bus.command(NmtCommand.START)
    for place in range(4):
        for base in (0x1400, 0x1800):
            bus.read(Address(base + place, 1))
            bus.read(Address(base + place, 2))
    if not bus.read(od.SUPPORTED_MODES) & Mode.PROFILE_VELOCITY.supported_bit:
        raise StartError("the mode is not supported")
    # A mode that is not shown in time is logged, and the master goes on.
    bus.write(od.MODE, Mode.PROFILE_VELOCITY, 1)
    bus.waits(500, lambda: bus.read(od.MODE_DISPLAY) == Mode.PROFILE_VELOCITY)
    ended = bus.now + 800_000_000
    while (state := bus.state) is not PowerState.OPERATION_ENABLED:
        if bus.now >= ended:
            raise StartError(f"it stayed in '{'unknown' if state is None else state.title}' for 0.8 s")
        command = towards(state, PowerState.OPERATION_ENABLED)
        if command is not None:
            bus.write(od.CONTROLWORD, word_of(command), 2)
        bus.waits(1)
    _turns(bus, 0x000F)


MASTERS: Final[Mapping[str, Callable[[Bus], None]]] = {
    "ros2_canopen": ros2_canopen,
    "ros_canopen": ros_canopen,
    "Lely": lely,
    "python-canopen": python_canopen,
}


def _booted(bus: Bus, within_ms: float) -> None:
    bus.command(NmtCommand.RESET_COMMUNICATION)
    if not bus.waits(within_ms, lambda: bus.booted):
        raise StartError(f"no boot-up message within {within_ms / 1000:g} s")
    bus.read(od.DEVICE_TYPE)
    bus.read(od.VENDOR_ID)


def _configured(bus: Bus, *, keeps_no_remote: bool) -> None:
    """Write heartbeat and the transmit PDO of the statusword, off while it changes; then start the node."""
    bus.write(od.PRODUCER_HEARTBEAT, 100, 2)
    cob_id = cia301.TRANSMIT_PDO[0] + NODE
    flag = cia301.COB_ID_NO_REMOTE if keeps_no_remote else 0
    try:
        bus.write(Address(STATUSWORD_PDO, 1), cia301.COB_ID_INVALID | flag | cob_id, 4)
        bus.write(Address(STATUSWORD_PDO, 2), SYNCHRONOUS, 1)
        bus.write(Address(STATUSWORD_PDO + 0x200, 0), 0, 1)
        bus.write(Address(STATUSWORD_PDO + 0x200, 1), 0x6041_0010, 4)
        bus.write(Address(STATUSWORD_PDO + 0x200, 0), 1, 1)
        bus.write(Address(STATUSWORD_PDO, 1), flag | cob_id, 4)
    except StartError as error:
        raise StartError(f"configuration failed: {error}") from error
    bus.command(NmtCommand.START)


def _drive_layer(bus: Bus) -> None:
    """Enable, take the mode with the halt bit set, and turn: one Controlword in each period."""
    try:
        modes = bus.read(od.SUPPORTED_MODES)
    except StartError as error:
        raise StartError(f"no mode is supported: {error}") from error
    if not modes & Mode.PROFILE_VELOCITY.supported_bit:
        raise StartError("the mode is not supported")
    for word in (0x0000, 0x0080):
        bus.write(od.CONTROLWORD, word, 2)
        _cycle(bus)
    _enabled(bus)
    # Its mode is changed in Operation enabled, with halt set.
    bus.write(od.CONTROLWORD, 0x000F | HALT, 2)
    _cycle(bus)
    bus.write(od.MODE, Mode.PROFILE_VELOCITY, 1)
    ended = bus.now + round(STEP_MS * 1e6)
    while bus.read(od.MODE_DISPLAY) != Mode.PROFILE_VELOCITY:
        if bus.now >= ended:
            raise StartError("mode switch timed out")
        _cycle(bus)
    _turns(bus, 0x000F)


def _enabled(bus: Bus) -> None:
    ended = bus.now + round(STEP_MS * 1e6)
    while True:
        payload = bus.received.get(cia301.TRANSMIT_PDO[0] + NODE, bytes(2))
        state = STATES.state_of(int.from_bytes(payload[:2], "little"))
        if state is PowerState.OPERATION_ENABLED:
            return
        if bus.now >= ended:
            raise StartError("could not enable the motor within 5 s")
        command = towards(state, PowerState.OPERATION_ENABLED)
        if command is not None:
            bus.write(od.CONTROLWORD, word_of(command), 2)
        _cycle(bus)


def _cycle(bus: Bus) -> None:
    bus.send(cia301.SYNC, b"")
    bus.waits(PERIOD_MS)


def _turns(bus: Bus, word: int) -> None:
    bus.write(od.CONTROLWORD, word, 2)
    bus.write(od.TARGET_VELOCITY, TURNS_RPM, 4)
    bus.waits(400)
    speed = bus.read(od.VELOCITY_ACTUAL)
    if abs(speed - TURNS_RPM) > TOLERANCE_RPM:
        raise StartError(f"it does not turn: {speed} rpm where {TURNS_RPM} are commanded")


def outcome(master: str, *variations: str) -> str:
    """Play a master's start against a servo with these variations; return "passes", or what it reports."""
    try:
        MASTERS[master](Bus(variations))
    except StartError as error:
        return str(error)
    return "passes"
