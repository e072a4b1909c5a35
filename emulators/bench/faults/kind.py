"""Description of a kind of fault: the physical event, and the emulated device's reaction."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from emulators.bench.faults.fault import Fault, Lasting


@dataclass(frozen=True, slots=True)
class FaultKind:
    """One kind of fault."""

    fault: type[Fault]
    happens: str
    """The physical event."""
    does: str
    """The emulated device's reaction."""
    acts_on: str = ""
    """Target: of two faults with one target on one node one must end before the other begins."""
    severe: tuple[Mapping[str, Any], ...] = ()
    """Other keys with which it is tried; empty: those of `emulators.bench.faults.severe`."""

    @property
    def name(self) -> str:
        """The field's name for it."""
        return self.fault.kind

    @property
    def bench_only(self) -> str:
        """Return why it is not possible on a real bus; empty where it is."""
        return self.fault.bench_only

    @property
    def lasts(self) -> bool:
        """True if it has an end; else it is an instant."""
        return issubclass(self.fault, Lasting)
