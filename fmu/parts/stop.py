"""An elastic stop that loses energy when it is hit: no force outside, never a pull (Hunt and Crossley)."""

from fmu.export.functions import positive_part
from fmu.export.model import Expression


def push(depth: Expression, inward: Expression, stiffness: Expression, damping: Expression) -> Expression:
    """Return the force of a stop that is entered by `depth` (0 outside) at the speed `inward`.

    K p (1 + c p'), cut off where it would pull; `damping` c is the share of force per speed.
    """
    return stiffness * depth * positive_part(1 + damping * inward)
