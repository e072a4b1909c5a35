"""What the robot stands on: four contacts at the corners of a trapezium, and how they share the weight.

Four contacts of a rigid robot are statically indeterminate by one. The rule here (assumed): front and rear
axle have the same share of their load on the left. A wheel's load then reaches 0 where the zero-moment
point meets an edge, and never before.
"""

import sympy as sp

from fmu.export.functions import clamped, larger, named, size
from fmu.export.model import Expression
from fmu.rars.platform import SIDES
from fmu.rars_tipping.symbols import P

REAR = P["rear_track"] / 2 - P["rear_contact_inset"]
"""Half of the support's width in m at the rear contacts, and at the front ones."""
FRONT = P["front_track"] / 2


def half_width(ahead: Expression) -> Expression:
    """Return half of the support's width in m so far ahead of the rear contacts."""
    return REAR + (FRONT - REAR) / P["wheelbase"] * ahead


def loads(weight: Expression, ahead: Expression, left: Expression) -> dict[str, Expression]:
    """Return the wheels' loads in N for a floor that pushes at this point within the support, in m."""
    front = named(ahead / P["wheelbase"])
    share = named(left / half_width(ahead))
    of_axle = {"rear": 1 - front, "front": front}
    return {
        f"{axle}_{side}": named(weight * part * (1 + sign * share) / 2)
        for axle, part in of_axle.items()
        for side, sign in SIDES.items()
    }


def within(ahead: Expression, left: Expression) -> tuple[Expression, Expression]:
    """Return the point of the support that is next to this one, first ahead and then to the left."""
    half = P["wheelbase"] / 2
    inside = half + clamped(ahead - half, half)
    return inside, clamped(left, half_width(inside))


def margin(ahead: Expression, left: Expression) -> Expression:
    """Return the distance of this point from the nearest edge in m, negative outside."""
    length = sp.sqrt(P["wheelbase"] ** 2 + (REAR - FRONT) ** 2)
    aside = (half_width(ahead) - size(left)) * P["wheelbase"] / length
    # The least of three distances.
    return -larger(larger(-ahead, ahead - P["wheelbase"]), -aside)
