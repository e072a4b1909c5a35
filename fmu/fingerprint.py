"""The fingerprint of a plant: the bits of a short fixed run, by which a differently compiled one is known.

The run is the same for every model: each input jumps to a fraction of its nominal value, again and again.
What it must give stands in the FMU, computed from the equations without a compiler.
"""

import hashlib
import json
import struct
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from typing import Final, Protocol, Self

RESOURCE: Final = "resources/fingerprint.json"
"""Place of the fingerprint in our FMUs."""
STEPS: Final = 400
STEPS_A_JUMP: Final = 25
_SPAN: Final = 1 << 31


class Stepped(Protocol):
    """Plant as the fixed run uses it."""

    def write(self, values: Sequence[float], /) -> None:
        """Set all inputs."""

    def step(self) -> None:
        """Take one communication step."""

    def read(self) -> Sequence[float]:
        """Return all outputs."""


@dataclass(frozen=True, slots=True)
class Fingerprint:
    """A run and what it must give: nominal values by input, outputs, step in ns, SHA-256 of all bits."""

    inputs: dict[str, float]
    outputs: list[str]
    step: int
    sha256: str

    def to_json(self) -> str:
        """Return the text of the resource."""
        return json.dumps(asdict(self), indent=2) + "\n"

    @classmethod
    def from_json(cls, text: bytes) -> Self:
        """Read the resource; ValueError or TypeError where it is something else."""
        return cls(**json.loads(text))


def measure(plant: Stepped, nominals: Sequence[float]) -> str:
    """Run a plant that has just been initialized; return the SHA-256 of its outputs' bits."""
    digest = hashlib.sha256()
    fractions = _fractions()
    for step in range(STEPS):
        if step % STEPS_A_JUMP == 0:
            plant.write([nominal * next(fractions) for nominal in nominals])
        plant.step()
        values = plant.read()
        # Little-endian doubles on every machine: it is the bits that are compared, not a tolerance.
        digest.update(struct.pack(f"<{len(values)}d", *values))
    return digest.hexdigest()


def _fractions() -> Iterator[float]:
    """Yield fractions in -1..1, always the same ones: a linear congruential generator of 31 bits."""
    state = 1
    while True:
        # Integers only, so that the same inputs come out whatever the machine's libm does.
        state = (state * 1_103_515_245 + 12_345) % _SPAN
        yield state / (_SPAN // 2) - 1.0
