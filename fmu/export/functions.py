"""Functions that equations may use besides SymPy's own: exact where a sum of absolute values would round."""

import math
from typing import Final

import sympy as sp
from sympy.utilities.lambdify import implemented_function

positive_part: Final = sp.Function("positive_part", real=True)
"""positive_part(x): x where it is positive, else exactly 0."""

clamped: Final = sp.Function("clamped", real=True)
"""clamped(x, b): x within -b..b, else the nearer bound."""

size: Final = implemented_function(sp.Function("size", real=True), abs)
"""size(x): |x|, of x as it is written: SymPy's own turns signs round and takes what is shared apart."""

angle: Final = implemented_function(sp.Function("angle", real=True), math.atan2)
"""angle(y, x): that of the way (x, y), atan(y / x), for x above 0; by one division."""

larger: Final = sp.Function("larger", real=True)
"""larger(x, y): the larger of two numbers."""

passed: Final = sp.Function("step_at", real=True)
"""passed(x): 1 where x is above 0, else 0; an event is needed where it turns."""

shared: Final = implemented_function(sp.Function("shared", real=True), lambda value: value)
"""shared(x): x, computed once as it is written: SymPy would take it apart wherever it stands in a sum."""

named: Final = implemented_function(sp.Function("named", real=True), lambda value: value)
"""named(x): x, a line of its own before SymPy looks for common parts: it looks at a tree, and would not end
where equations are nested deeply."""

reciprocal: Final = sp.Function("reciprocal", real=True)
"""reciprocal(x): 1 / x, divided once and shared: SymPy would make a division of each of its powers."""
