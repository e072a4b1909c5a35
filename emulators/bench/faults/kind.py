"""What is said of a kind of fault: what happens physically, and what the emulated device makes of it."""

from dataclasses import dataclass

from emulators.bench.faults.fault import Fault, Lasting


@dataclass(frozen=True, slots=True)
class Kind:
    """One kind of fault."""

    fault: type[Fault]
    happens: str
    """What happens physically."""
    does: str
    """What the emulated device does."""
    acts_on: str = ""
    """Of two faults that act on the same thing of the same node one must end before the other begins."""

    @property
    def name(self) -> str:
        """The field's name for it."""
        return self.fault.kind

    @property
    def lasts(self) -> bool:
        """Whether it has an end; else it is an instant."""
        return issubclass(self.fault, Lasting)
