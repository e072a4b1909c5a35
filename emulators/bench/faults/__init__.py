"""Faults that a mission, or a program, names by the field's names: a table of kinds, put on and taken off."""

from emulators.bench.faults.fault import CABLE_ORDER, Fault, Lasting
from emulators.bench.faults.kind import FaultKind
from emulators.bench.faults.reading import ROBOT, WRONG, FaultTable, misfits, read
from emulators.bench.faults.schedule import FaultError, Faults
from emulators.bench.faults.site import BRIDGE, OPERATOR_STATION, SECOND_BRIDGE, Site
from emulators.bench.faults.table import kinds

__all__ = [
    "BRIDGE",
    "CABLE_ORDER",
    "OPERATOR_STATION",
    "ROBOT",
    "SECOND_BRIDGE",
    "WRONG",
    "Fault",
    "FaultError",
    "FaultKind",
    "FaultTable",
    "Faults",
    "Lasting",
    "Site",
    "kinds",
    "misfits",
    "read",
]
