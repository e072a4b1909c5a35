"""The kinds of incidents, one row each: causes, consequence, and the first thing to check.

Sources: CiA 301 v4.02 (error control, emergency, PDO, SDO), CiA 402-2, Linux `linux/can/error.h`.
"""

from typing import Final

from firmware_bridge.explain.incident import IncidentKind

EMERGENCY: Final = IncidentKind(
    "emergency",
    "a drive reports an error",
    ("the cause that the error code names",),
    "a drive that reacts with a fault switches its power stage off, at once or after a ramp",
    "the error history 0x1003 of the drive, and what the error code names",
)
RESTART: Final = IncidentKind(
    "restart",
    "a node has started again without a reset command",
    (
        "its logic supply was interrupted: a loose plug, a weak battery",
        "it was reset by its watchdog, or by a command on another line, as USB",
    ),
    "its power stage is off, it is pre-operational, and what was not saved is lost: PDOs, modes, position",
    "the supply and the plug of the node; then set it up again",
)
SILENT: Final = IncidentKind(
    "silent_node",
    "a node is silent",
    (
        "its plug or its supply is out",
        "its CAN controller has left the bus (bus off), or its driver drops frames",
        "the cable is cut between it and the recording",
        "its producer heartbeat time 0x1017 was changed",
    ),
    "who consumes its heartbeat misses it, and set-points may not reach it",
    "supply, plug and LED of the node, then the cable",
)
SILENT_CONTROLLER: Final = IncidentKind(
    "controller_silent",
    "the controller's heartbeat has stopped",
    (
        "its program hangs, has ended, or was suspended",
        "its CAN plug is out, or its controller is off the bus",
    ),
    "drives that consume the heartbeat (0x1016) report 0x8130 and stop by 0x6007",
    "the log of the controller's program, then its CAN interface (`ip -details link show`)",
)
WITHHELD: Final = (
    "it is withheld on purpose, to prove that the drives notice it: requests go on, and no drive has power"
)
"""Cause of a controller's silence, before the others where the frames show it."""
SECOND_PRODUCER: Final = IncidentKind(
    "second_producer",
    "two nodes send the same identifier",
    (
        "a second controller or a tool is on the bus",
        "two nodes have the same node number",
        "a recording is replayed onto the bus",
    ),
    "frames of both may collide on the wire, and drives obey both",
    "programs and tools on the bus; unplug one after the other",
)
NMT_WHILE_ENABLED: Final = IncidentKind(
    "nmt_while_enabled",
    "a network command for a drive that is enabled",
    ("a second controller, or a tool that was plugged in", "the controller's own program ends or restarts"),
    "stopped or pre-operational it takes no set-point by PDO; a reset switches its power stage off",
    "which program sends 0x000; it should stop the drive first",
)
FAULT: Final = IncidentKind(
    "fault",
    "a drive is in the state fault",
    ("an error whose emergency is not in the recording: see 0x603F or 0x1003 of the drive",),
    "the power stage is off; the drive takes no command but a fault reset",
    "the error history 0x1003; the emergency's identifier 0x1014",
)
QUICK_STOP: Final = IncidentKind(
    "quick_stop",
    "quick stop active",
    (
        "the drive's own reaction: a limit switch, a lost connection (0x6007)",
        "a quick stop command that is not in the recording",
    ),
    "the drive has stopped by its quick-stop ramp and takes no set-point",
    "inputs of the drive; it leaves the state by controlword 0x000F, or by 0x0000 without power",
)
LOST_ENABLE: Final = IncidentKind(
    "lost_enable",
    "a drive left operation enabled without a command",
    (
        "its power supply or its enable input is off",
        "a command on another line: a second client, USB, an input",
    ),
    "the motor is without power: the axis rolls out or is held by its brake only",
    "the power supply, the enable input, and other clients of the drive",
)
SDO_ABORT: Final = IncidentKind(
    "sdo_abort",
    "an SDO transfer was refused",
    ("the object, its length, its range or the state of the device does not allow it",),
    "the object is unchanged, or was not read",
    "the object in the device's data sheet (EDS), and the state in which it may be written",
)
SDO_TIMEOUT: Final = IncidentKind(
    "sdo_timeout",
    "an SDO request was not answered",
    (
        "the node has no supply, or is not on this bus",
        "it is in the NMT state stopped, where it has no SDO",
        "the answer was lost: a bad plug, too high a bus load",
    ),
    "the client waits for its time-out; the object is unchanged, or was not read",
    "number, supply and bit rate of the node",
)
NO_NODE: Final = IncidentKind(
    "no_node",
    "a node was commanded and never sent a frame",
    (
        "there is no node with this number: a wrong number in the program, or in the DIP switches",
        "it has another bit rate, no supply, or a loose plug",
    ),
    "nothing that was sent to it has an effect",
    "node number, bit rate, supply and plug",
)
SYNC_GAP: Final = IncidentKind(
    "sync_gap",
    "SYNC has stopped",
    ("the controller's cycle has stopped or stalls", "frames of lower identifiers take the bus"),
    "synchronous PDOs are neither taken nor sent: drives go on with the last set-points",
    "the controller's cycle, and the load of its computer",
)
FOLLOWING_ERROR: Final = IncidentKind(
    "following_error",
    "following error, statusword bit 13",
    ("the axis is blocked or overloaded", "the ramp is too steep", "the current limit is too low"),
    "the drive may report 0x8611 and stop",
    "free movement of the axis; then 0x6065 and the ramps 0x6083 and 0x6084",
)
INTERNAL_LIMIT: Final = IncidentKind(
    "internal_limit",
    "internal limit active, statusword bit 11",
    (
        "the drive limits its current (I2t): load, friction, a brake that is closed",
        "a target is beyond 0x607D, or a velocity beyond 0x607F",
    ),
    "the axis moves more slowly than commanded, or not at all",
    "the load, the brake, and the current limits",
)
ERROR_FRAMES: Final = IncidentKind(
    "error_frames",
    "the CAN interface reports errors",
    (
        "no other node acknowledges: the bus is unplugged, or all nodes are without supply",
        "another bit rate, a missing termination, a bad plug",
    ),
    "frames are sent again and again, or are lost",
    "termination (60 ohm between CAN high and low without supply), bit rate, plugs",
)
BUS_OFF: Final = IncidentKind(
    "bus_off",
    "the CAN interface is off the bus",
    ("CAN high and low are exchanged or short", "another bit rate", "a disturbed cable"),
    "it sends and receives nothing until it is restarted",
    "wiring and bit rate; then `ip link set can0 type can restart-ms 100`",
)
BABBLING: Final = IncidentKind(
    "babbling",
    "one identifier takes the bus",
    ("a node sends without end: a program that loops, a defective node", "a recording is replayed"),
    "frames of higher identifiers come late or not at all; heartbeats may be missed",
    "which node sends this identifier; unplug it",
)
BUS_LOAD: Final = IncidentKind(
    "bus_load",
    "the bus is nearly full",
    ("too many PDOs, or too short a cycle", "the bit rate is other than assumed"),
    "frames of high identifiers come late",
    "inhibit times of the PDOs (0x1800:3), the cycle, the bit rate",
)
WRONG_LENGTH: Final = IncidentKind(
    "pdo_length",
    "a PDO with another length than its mapping",
    (
        "sender and receiver have other mappings",
        "a second sender uses the same identifier",
    ),
    "a PDO that is too short is not taken (0x8210); values of a longer one may be read wrongly",
    "the mappings 0x1600 and 0x1A00 of the node",
)
STUCK: Final = IncidentKind(
    "not_moving",
    "a drive is commanded and does not move",
    ("no reason is in the frames: a closed brake, no motor current, a blocked axis",),
    "the axis stays where it is",
    "brake, motor cable, and the actual current of the drive",
)

KINDS: Final = (
    EMERGENCY,
    RESTART,
    SILENT,
    SILENT_CONTROLLER,
    SECOND_PRODUCER,
    NMT_WHILE_ENABLED,
    FAULT,
    QUICK_STOP,
    LOST_ENABLE,
    SDO_ABORT,
    SDO_TIMEOUT,
    NO_NODE,
    SYNC_GAP,
    FOLLOWING_ERROR,
    INTERNAL_LIMIT,
    ERROR_FRAMES,
    BUS_OFF,
    BABBLING,
    BUS_LOAD,
    WRONG_LENGTH,
    STUCK,
)
"""Every kind, as the page of the command lists them."""
