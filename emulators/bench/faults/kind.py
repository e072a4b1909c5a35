"""Description of a kind of fault: the physical event, and the emulated device's reaction."""

from dataclasses import dataclass

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

    @property
    def name(self) -> str:
        """The field's name for it."""
        return self.fault.kind

    @property
    def lasts(self) -> bool:
        """True if it has an end; else it is an instant."""
        return issubclass(self.fault, Lasting)
