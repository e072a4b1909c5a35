"""RARS on tires whose steady friction follows the magic formula, [R] (3.45); all else is fmu/rars."""

import sympy as sp

from fmu.export.functions import larger, reciprocal, shared
from fmu.export.model import Expression, Model
from fmu.parts.symbols import symbol
from fmu.parts.tyre import Tyre
from fmu.rars.equations import model_of
from fmu.rars.platform import Platform
from validation.plants.rars_magic.parameters import PARAMETERS


def magic(slip: Expression) -> Expression:
    """Return Y / D = sin(C atan(B x - E (B x - atan(B x)))) (3.45); D is the largest friction."""
    along = shared(symbol("magic_b") * slip)
    bent = shared(along - symbol("magic_e") * (along - sp.atan(along)))
    return shared(sp.sin(symbol("magic_c") * sp.atan(bent)))


class MagicTyre(Tyre):
    """The bristle of fmu/parts, in steady state Y(lambda) in place of (3.83)."""

    def _slide(self, way: int) -> tuple[Expression, Expression]:
        """Return D and mu N, both times the same: D is speed / Y, and the speed alone at rest."""
        speed = self._both(self._slipping, way)
        slip = self._both((self._slipping[0], shared(self._angle * self._over)), way)  # lambda, times `over`
        lam = shared(slip * reciprocal(self._over))
        share = magic(lam)
        return speed * larger(self._rolling * lam, slip * share), slip * share * self._grip


class MagicPlatform(Platform):
    """RARS's platform on such tires."""

    tyre = MagicTyre


def model() -> Model:
    """Return the equations of motion with all tables."""
    return model_of("rars_magic", "RARS on tires by the magic formula, [R] (3.45)", PARAMETERS, MagicPlatform)
