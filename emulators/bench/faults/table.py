"""Every kind of fault, one row each: the physical cause, and the reaction of the emulated device."""

from collections.abc import Mapping
from functools import cache
from typing import Final

from emulators.bench.faults import bus, device, link, people, plant
from emulators.bench.faults.kind import FaultKind
from emulators.family import families
from emulators.wires.faulty_can import WAITING

_CONNECTION: Final = "the connection"
_SUPPLY: Final = "the supply"

_FIRST: Final = (
    FaultKind(
        bus.FrameError,
        "A disturbance on the cable flips a bit. All nodes see it, an error flag ends the frame, and its"
        " sender sends it again at once. Each costs 8 and each good frame gives 1 back, so above one in"
        " nine the counters climb: with every frame of a node damaged its controller is passive after 16"
        " and off the bus after 32.",
        "Counts 8 for each frame of its own, 1 for each of others, by ISO 11898-1. EMCY 0x8120 when it"
        " grows passive, 0x81FD when it is back from bus off; both stop the motor, and only NMT"
        " reset communication clears 0x8120.",
    ),
    FaultKind(
        bus.ReceptionError,
        "A bad plug or termination at one node: this node alone sees errors in frames, and its error flag"
        " destroys them for all, until it is passive after some 15; from then on it alone misses them.",
        "As with `frame_error`: EMCY 0x8120 when it is passive. It receives no set-point and no heartbeat"
        " any more, so EMCY 0x8130 follows after 0x1016.",
    ),
    FaultKind(
        bus.FrameLoss,
        "A driver, an adapter or a full queue between a node's program and its controller drops"
        " frames: nothing is on the cable, and no node detects it.",
        "Sends as before, but is not received. It receives everything.",
    ),
    FaultKind(
        bus.ReceiveOverrun,
        "The bus works, but a node's program does not fetch frames from its controller in time.",
        "Does not get them, and reports EMCY 0x8110 (object lost), which stops its motor.",
    ),
    FaultKind(
        bus.BusOff,
        "All frames of a node are damaged until its controller leaves the bus (32 of them, some 4 ms);"
        " no one restarts the controller before the end. A bridge on a real bus ends then; this one goes"
        " on when its controller is back.",
        "Sends and receives nothing: no heartbeat of the bridge. Back on the bus it reports EMCY 0x81FD,"
        " and 0x8130 if that took long enough; 0x8120, on its way off, was received by no one and stays in"
        " its history.",
        _CONNECTION,
    ),
    FaultKind(
        bus.CanCut,
        "The bus is cut in two segments that receive nothing of each other. A node alone on its segment gets"
        " no acknowledgement, repeats its frame until it is passive, and sends it when the cable is whole"
        f" again, with up to {WAITING} frames that have waited. Reflections at the open ends are not"
        " emulated.",
        "On the far side: misses the bridge's heartbeat, EMCY 0x8130, stops by 0x6007. Alone: EMCY"
        " 0x8120, too.",
        _CONNECTION,
    ),
    FaultKind(
        bus.CanSwapped,
        "The node receives nothing and is not understood. As soon as it has a frame to send no one"
        " acknowledges it, and its repetitions pull the bus the wrong way: they destroy all nodes'"
        " frames, until all controllers are off the bus, again and again.",
        "All nodes: EMCY 0x8120 and 0x81FD, and 0x8130 as no one receives the bridge. None of these is"
        " received before the wires are corrected.",
        _CONNECTION,
    ),
    FaultKind(
        bus.BabblingNode,
        "An unknown node sends without end. Lower identifiers win the bus, so frames of others"
        " come late or not at all.",
        "Its frames wait; heartbeats may come too late for their consumers (EMCY 0x8130).",
        "the foreign node",
    ),
    FaultKind(
        bus.NmtForeignNode,
        "A second controller, or a tool that was plugged in, sends a network command. Instantaneous: no end.",
        "Obeys. Stopped or pre-operational it takes no set-point and sends no process data, and by"
        " itself stops no motion (assumed, to be verified); a reset disables the power stage, and the"
        " position counter begins at 0.",
    ),
    FaultKind(
        bus.StrayFrames,
        "A second controller, or a tool that replays a log, sends one frame again and again: a SYNC, a"
        " set-point, the bridge's own heartbeat.",
        "Obeys it as it would the bridge's.",
        "the foreign node",
    ),
    FaultKind(
        bus.NodeSilent,
        "All cables of a node are out, or its transceiver is dead; it keeps running.",
        "Misses the bridge's heartbeat: EMCY 0x8130, which no one receives, and it stops by 0x6007."
        " If it is the bridge, all drives do so.",
        _CONNECTION,
    ),
    FaultKind(
        device.DriveRestart,
        "The supply of one drive is interrupted, logic included (a loose plug). The motor is without"
        " power and rolls out; with the supply the drive starts again.",
        "Sends the boot-up message after its boot time, is pre-operational and not enabled, has its"
        " saved parameters, and counts positions from 0.",
        _CONNECTION,
    ),
    FaultKind(
        device.SetPointsIgnored,
        "The program part of a drive that takes set-points hangs; its regulators, its communication and its"
        " heartbeat consumer keep running.",
        "Takes every controlword and every target, by PDO, SDO or serial line, carries out none, and goes on"
        " with its last command. It reports Operation enabled all the time. A lost heartbeat, a fault"
        " of its own and a reset still stop it (assumed, to be verified).",
        "the drive's set-points",
    ),
    FaultKind(
        device.SupplySag,
        "A weak battery, a long cable or a bad contact: only `to_v` is left at the drives. The logic"
        " keeps running.",
        "Below its limit (10 V, assumed, to be verified): EMCY 0x3220, power stage off at once; the motor"
        " rolls out. Above it: less voltage for the winding.",
        _SUPPLY,
    ),
    FaultKind(
        device.SupplySurge,
        "A charger, or energy that braking motors feed back into a supply that cannot take it.",
        "Above its limit: EMCY 0x3210, power stage off at once; the motor rolls out.",
        _SUPPLY,
    ),
    FaultKind(
        device.LogicSupplySag,
        "A short in a sensor's cable pulls the drive's 5 V down.",
        "EMCY 0x5113, power stage off at once.",
        "the logic supply",
    ),
    FaultKind(
        device.GateSupplySag,
        "The supply of the power stage's gate drivers fails.",
        "EMCY 0x5114, power stage off at once.",
        "the gate supply",
    ),
    FaultKind(
        device.Overheating,
        "The air at the heat sink is hot: a fan has stopped, or the sun shines on the housing.",
        "The current's own heat is added; too hot: EMCY 0x4210, power stage off at once.",
        "the air",
    ),
    FaultKind(
        device.EncoderCut,
        "The encoder's cable is out: no count, no index.",
        "EMCY 0xFF0A, power stage off at once; the position is no longer referenced. When the cable is"
        " back, the first index comes at a wrong count: 0xFF03 where 0x2210 enables monitoring of the index.",
        "the encoder's cable",
    ),
    FaultKind(
        device.EncoderSwapped,
        "Channels A and B are exchanged: the count runs against the motor, and the regulator drives it"
        " away. At standstill it has no effect.",
        "A board: notices nothing, and its motor runs away at full speed (`uncommanded motion` in the"
        " bridge). A drive: EMCY 0xFF02 or 0xFF03 within a turn where 0x2210 enables monitoring of the"
        " index; else 0xFF11, at full voltage with the count running the other way, or 0x8611, when the"
        " following error is too large.",
        "the encoder's channels",
    ),
    FaultKind(
        device.EncoderCountsLost,
        "Disturbed lines or a dirty disc: of the quadcounts a share does not arrive, so the shaft turns"
        " further than the drive counts.",
        "Counts less. It detects this only where 0x2210 enables monitoring of the index (EMCY 0xFF02,"
        " 0xFF03).",
        "the encoder's counts",
    ),
    FaultKind(
        device.EncoderFrozen,
        "The coupling between shaft and encoder is loose: the disc does not turn with the shaft. All lines"
        " have valid levels, and there are neither counts nor index pulses.",
        "Measures an axis at standstill, and increases its output up to the limit: 0x8611 in position mode,"
        " when the following error is too large; no error in velocity mode.",
        "the encoder's counts",
    ),
    FaultKind(
        device.IndexMissing,
        "The index line of the encoder is broken.",
        "EMCY 0xFF02 after some turns where 0x2210 enables monitoring of the index; else nothing.",
        "the index",
    ),
    FaultKind(
        device.IndexSpurious,
        "A disturbance on the index line: a second pulse an eighth of a turn after the first.",
        "EMCY 0xFF02 or 0xFF03 where 0x2210 enables monitoring of the index; else nothing.",
        "the index",
    ),
)
"""Faults of a bus and of the devices on it."""
_LAST: Final = (
    FaultKind(
        link.DatagramLoss,
        "The radio link loses datagrams.",
        "No device: interlock `operator link timeout` after `operator.silent_ms`.",
    ),
    FaultKind(
        link.DatagramLate,
        "Datagrams queue up on the way and arrive late. When the fault ends, later ones overtake them.",
        "No device: at the beginning the bridge receives nothing for the delay, and then old commands as if"
        " they were new: MANUAL_CONTROL carries no time.",
    ),
    FaultKind(
        link.DatagramDoubled,
        "The network delivers datagrams twice.",
        "No device: a command counts once, and its repetition is answered again.",
    ),
    FaultKind(
        link.SerialUnplugged,
        "The USB or RS232 adapter of a bridge on a serial line is pulled out.",
        "The gateway misses its host; its heartbeat consumer for another drive stops the motors. In the"
        " bridge the interlock `link lost` is active.",
        "the serial line",
    ),
    FaultKind(
        plant.GripLost,
        "The adhesion of the robot on a wall is lost at one axis: a magnet over paint or rust. If the others"
        " cannot hold it, it falls.",
        "No device detects it; the motor keeps turning, without load if the robot has fallen.",
        "the grip",
    ),
    FaultKind(
        people.BridgeEnds,
        "Ctrl-C is pressed, once or twice, or the bridge's process is killed: queued messages are not sent."
        " When the fault ends, a bridge is started. From the one before it knows only the file of axis"
        " positions, which it offers for confirmation.",
        "On an orderly end the bridge brings it to standstill, disables its power stage and its heartbeat"
        " consumer. Killed: it misses the bridge's heartbeat, EMCY 0x8130, and stops by 0x6007.",
        _CONNECTION,
    ),
    FaultKind(
        people.BridgeSuspended,
        "The bridge's process is not run: it was stopped by its shell, or its machine sleeps. What is sent to"
        " it waits, up to 256 packets; when the fault ends, it receives them all at once and goes on.",
        "It misses the bridge's heartbeat, EMCY 0x8130, and stops by 0x6007; a board stops by its watchdog."
        " The bridge trips `bridge stalled`, and disarms.",
        _CONNECTION,
    ),
    FaultKind(
        people.SecondBridge,
        "A second bridge is started on the same bus, and ended by Ctrl-C when the fault ends.",
        "No device: the second bridge receives the first one, reports it and sends nothing.",
        "the second bridge",
    ),
    FaultKind(
        people.SecondStation,
        "A second ground station joins: it holds a stick, and may send a request twice a second.",
        "No device: the station in control stays in control. The other's stick and commands are refused,"
        " but an emergency stop is accepted from any station; it may take control if no station has it, or"
        " once it is released.",
        "the second station",
    ),
)


@cache
def kinds() -> Mapping[str, FaultKind]:
    """Return every kind by its name: those of buses and drives, the families' own, links, people."""
    own = [kind for family in families().values() for kind in family.faults()]
    return {row.name: row for row in (*_FIRST, *own, *_LAST)}
