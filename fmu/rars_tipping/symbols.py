"""Symbols of the parameters of RARS that can tip over."""

from typing import Final

from fmu.parts.symbols import symbols
from fmu.rars_tipping.parameters import PARAMETERS

P: Final = symbols(PARAMETERS)
