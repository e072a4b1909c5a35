"""Error codes of drives and refusals of SDO: likely causes in the machine, and the first thing to check.

The errors' own texts are in the families' tables; this is what an engineer looks at. Sources: CiA 301 v4.02
(classes of codes), CiA 402-2, EPOS Firmware Specification (causes and reactions), by analogy.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from firmware_bridge.canopen.abort import AbortCode

_GROUP: Final = 0xF000


@dataclass(frozen=True, slots=True)
class Remedy:
    """Causes of an error, the most likely one first, and what to check."""

    causes: tuple[str, ...]
    check: str
    reset: str = "controlword 0x0080, a 0 -> 1 change of bit 7, when the cause is gone"


_COMMUNICATION: Final = "NMT reset communication first, then controlword 0x0080"
_LIMIT: Final = "move away from the switch; check its polarity and its input"

REMEDIES: Final = {
    0x1000: Remedy(
        ("an error that the drive does not name",), "the error history 0x1003, and the drive's manual"
    ),
    0x2310: Remedy(
        ("a short in motor or cable", "too steep a ramp for the load"), "motor cable and current limits"
    ),
    0x2320: Remedy(("a short in motor or cable",), "motor and cable, with an ohmmeter"),
    0x3210: Remedy(
        ("a braking motor feeds energy back", "too high a supply"),
        "supply voltage while braking; a brake chopper or a less steep ramp",
    ),
    0x3220: Remedy(
        ("a weak battery, or a supply with a current limit", "a long or thin cable, a bad contact"),
        "supply voltage at the drive's plug while the motor starts",
    ),
    0x4210: Remedy(("too much current for too long", "a fan or a heat sink is missing"), "load and cooling"),
    0x4310: Remedy(("too much current for too long", "a fan or a heat sink is missing"), "load and cooling"),
    0x5113: Remedy(("a short in a sensor's cable",), "unplug encoder and hall sensors one after the other"),
    0x5114: Remedy(("the supply of the gate drivers has failed",), "the supply; else the drive is defective"),
    0x5442: Remedy(("the axis has reached its positive limit switch",), _LIMIT),
    0x5443: Remedy(("the axis has reached its negative limit switch",), _LIMIT),
    0x6100: Remedy(
        ("saved parameters are lost or of another firmware",), "load defaults, set up and save again"
    ),
    0x6320: Remedy(
        ("a target too far for too low a velocity", "parameters that contradict each other"),
        "the parameters written last, and 0x6081, 0x6083, 0x6084",
    ),
    0x7305: Remedy(("encoder cable out or disturbed",), "encoder plug and cable"),
    0x7320: Remedy(("encoder cable out or disturbed",), "encoder plug and cable; then home again"),
    0x8110: Remedy(
        ("more frames than the drive can take", "two controllers send to it"), "cycle time and bus load"
    ),
    0x8111: Remedy(("more frames than the drive can take",), "cycle time and bus load"),
    0x8120: Remedy(
        ("a missing termination, a bad plug", "it was alone on its part of the cable: a cut cable"),
        "termination, plugs and cable near this node",
        _COMMUNICATION,
    ),
    0x8130: Remedy(
        (
            "the controller's heartbeat did not come in time: its program hung or ended",
            "the cable between controller and drive was cut",
            "consumer time 0x1016 shorter than the producer's 0x1017 plus its jitter",
        ),
        "the controller's heartbeat in the frames before; then 0x1016",
    ),
    0x8150: Remedy(("two nodes have the same number or the same COB-ID",), "node numbers and COB-IDs"),
    0x81FD: Remedy(
        ("CAN high and low exchanged or short", "another bit rate", "a disturbed cable"),
        "wiring, termination and bit rate",
    ),
    0x81FE: Remedy(("more frames than the drive can take",), "cycle time and bus load"),
    0x81FF: Remedy(("the bus is full, or no one acknowledges",), "bus load, cable and termination"),
    0x8210: Remedy(
        ("the controller's mapping is shorter than the drive's",), "0x1600 to 0x1603 on both sides"
    ),
    0x8250: Remedy(("the controller's cycle has stopped", "event time 0x1400:5 too short"), "the controller"),
    0x8611: Remedy(
        ("the axis is blocked or overloaded", "too steep a ramp", "the encoder counts the wrong way"),
        "free movement, brake, current limit; then 0x6065",
    ),
    0x8612: Remedy(("a target beyond 0x607D",), "target and limits 0x607D"),
    0xFF01: Remedy(("hall cable out, or wired in another order",), "hall sensors' plug and order"),
    0xFF02: Remedy(("index line broken or disturbed",), "encoder cable and its shield"),
    0xFF03: Remedy(
        ("lost or additional counts: a disturbed line, channels A and B exchanged", "a wrong pulse number"),
        "encoder cable, its order, and pulse number 0x2210",
    ),
    0xFF04: Remedy(("hall cable out",), "hall sensors' plug and supply", "NMT reset node"),
    0xFF06: Remedy(("the axis has reached its negative limit switch",), _LIMIT),
    0xFF07: Remedy(("the axis has reached its positive limit switch",), _LIMIT),
    0xFF08: Remedy(("hall sensors and winding do not fit",), "order of hall sensors and phases"),
    0xFF09: Remedy(("a target or the axis is beyond 0x607D",), "target, home position and limits 0x607D"),
    0xFF0A: Remedy(("encoder cable out or broken",), "encoder plug and cable; then home again"),
    0xFF0B: Remedy(("more commands than the drive can take",), "cycle time of set-points"),
    0xFF0C: Remedy(
        ("the buffer ran empty or over", "a record too far away"), "feeding of 0x20C1; then 0x20C4"
    ),
    0xFF0D: Remedy(("the motor cannot move freely while it is identified",), "load and brake"),
    0xFF0F: Remedy(("gear ratio missing or out of range",), "gear ratio of the dual loop"),
    0xFF10: Remedy(("gains out of range",), "0x60F9 and 0x60FB"),
    0xFF11: Remedy(("encoder counts against the motor",), "encoder polarity 0x2210 and its channels"),
    0xFF12: Remedy(("auxiliary encoder counts against the main one",), "polarity of the auxiliary encoder"),
}
"""By error code."""

ABORT_CHECKS: Final[Mapping[int, str]] = {
    AbortCode.TOGGLE: "two clients that use the same SDO server at once",
    AbortCode.TIMEOUT: "supply, bit rate and number of the node",
    AbortCode.UNKNOWN_COMMAND: "whether the client sends block transfers, which not every device has",
    AbortCode.UNSUPPORTED_ACCESS: "access of the object in the EDS",
    AbortCode.WRITE_ONLY: "the object can be written only",
    AbortCode.READ_ONLY: "the object can be read only",
    AbortCode.NO_OBJECT: "the index, in the EDS of this device and firmware",
    AbortCode.NOT_MAPPABLE: "whether the EDS allows PDO mapping for the object, and in this direction",
    AbortCode.PDO_LENGTH: "the sum of the mapped bits: 64 at most",
    AbortCode.PARAMETER_CLASH: "the values written before",
    AbortCode.LENGTH: "the size of the value: the object's own, from the EDS",
    AbortCode.TOO_LONG: "the size of the value: the object's own, from the EDS",
    AbortCode.TOO_SHORT: "the size of the value: the object's own, from the EDS",
    AbortCode.NO_SUBINDEX: "the sub-index; sub-index 0 gives the highest one",
    AbortCode.RANGE: "range of the object in the EDS",
    AbortCode.TOO_HIGH: "range of the object in the EDS",
    AbortCode.TOO_LOW: "range of the object in the EDS",
    AbortCode.LIMITS_CROSSED: "the other limit: write it first",
    AbortCode.CANNOT_STORE: "the power stage: many devices store only without power",
    AbortCode.LOCAL_CONTROL: "another client, as USB, which has the control",
    AbortCode.DEVICE_STATE: "the state: PDOs are mapped in pre-operational, modes often without power",
    AbortCode.WRONG_NODE: "the node number, 1 to 127",
    AbortCode.WRONG_PASSWORD: "the value: 'save' for 0x1010, 'load' for 0x1011",
    AbortCode.ILLEGAL_COMMAND: "the command of the serial protocol",
    AbortCode.WRONG_NMT_STATE: "the NMT state: send pre-operational first",
}
"""What to check where a client of a CAN bus was refused."""

CLASSES: Final = {
    0x1000: "generic error",
    0x2000: "current",
    0x3000: "voltage",
    0x4000: "temperature",
    0x5000: "device hardware",
    0x6000: "device software",
    0x7000: "additional modules, as sensors",
    0x8000: "monitoring: communication, following error",
    0x9000: "external error",
    0xF000: "additional functions, or the maker's own errors",
}
"""The classes of CiA 301, by the first hexadecimal digit."""


def class_of(code: int) -> str:
    """Return what the class of an error code is about; empty for a reserved class."""
    return CLASSES.get(code & _GROUP, "")


def remedy_of(code: int) -> Remedy:
    """Return causes and check of an error; those of its class where the code itself is not known."""
    known = REMEDIES.get(code)
    if known is not None:
        return known
    about = class_of(code) or "an unknown class of errors"
    return Remedy((f"an error of this class: {about}",), "the maker's list of errors")
