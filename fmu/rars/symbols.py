"""Symbols of RARS's parameters."""

from typing import Final

from fmu.parts.symbols import symbols
from fmu.rars.parameters import PARAMETERS

P: Final = symbols(PARAMETERS)
