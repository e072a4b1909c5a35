"""The plant in Python, line for line as in C: the reference for the bits of a right compilation.

Python's numbers are IEEE 754 doubles, rounded after every operation and never contracted. For short runs.
"""

from collections.abc import Callable, Sequence
from math import sqrt
from typing import Any, Final

from fmu.export.blocks import Block, ModelCode
from fmu.export.code import body
from fmu.fingerprint import Fingerprint, measure

_NS: Final = 1_000_000_000
_HALF_PI: Final = 1.5707963267948966
_PARTS: Final = (1.5707963267341256, 6.077100506303966e-11, 2.0222662487959506e-21)
_MAGIC: Final = 6755399441055744.0
_SINE: Final = (
    -1.0 / 6.0, 1.0 / 120.0, -1.0 / 5040.0, 1.0 / 362880.0,
    -1.0 / 39916800.0, 1.0 / 6227020800.0, -1.0 / 1307674368000.0, 1.0 / 355687428096000.0,
)  # fmt: skip
_COSINE: Final = (
    1.0 / 24.0, -1.0 / 720.0, 1.0 / 40320.0, -1.0 / 3628800.0,
    1.0 / 479001600.0, -1.0 / 87178291200.0, 1.0 / 20922789888000.0, 0.0,
)  # fmt: skip
_ARC_TANGENT: Final = (
    -0.3333333333333333, 0.1999999999999552, -0.14285714284666542, 0.11111111015256361, -0.09090904578123903,
    0.07692183190826087, -0.06664511447381948, 0.0585814891280221, -0.0508544973794026, 0.03923165829558719,
    -0.01917688711906226, 0.0,
)  # fmt: skip
"""Coefficients as in c/elementary.h, the lowest power first; a test compares them bit for bit."""


class ReferenceModel:
    """One instance with its default parameters, initialized."""

    def __init__(self, program: ModelCode) -> None:
        model = program.model
        run: dict[str, Callable[..., None]] = {block.name: _compiled(block) for block in program.blocks}
        count = max(len(block.results) for block in program.blocks if block.name == "constants")
        self._p = [float(row.start) for row in model.parameters]
        self._k = [0.0] * count
        self._inputs = model.inputs
        self._u = [0.0] * len(model.inputs)
        self._s = [0.0] * len(model.states)
        self._reading = [0.0] * len(program.readings)
        self._outputs = len(program.outputs)
        self._inner_step = model.inner_step
        self._rates, self._reads = run["rates"], (run["outputs"], run["derived"])
        self.length = model.inner_step
        run["constants"](p=self._p, k=self._k)
        run["starts"](p=self._p, k=self._k, s=self._s)

    def write(self, values: Sequence[float]) -> None:
        """Set all inputs, switches within 0 and 1."""
        self._u[:] = [
            min(max(value, 0.0), 1.0) if row.switch else value
            for row, value in zip(self._inputs, values, strict=True)
        ]

    def step(self) -> None:
        """Take one communication step of `length` seconds, as step.c does."""
        # Rounded up but for rounding errors, as in step.c: 100 us are two inner steps of 50 us, not three.
        count = max(1, int(self.length / self._inner_step + 0.999999))
        for _ in range(count):
            self._integrate(self.length / float(count))

    def read(self) -> Sequence[float]:
        """Return all outputs."""
        for read in self._reads:
            read(s=self._s, u=self._u, p=self._p, k=self._k, reading=self._reading)
        return self._reading[: self._outputs]

    def _integrate(self, h: float) -> None:
        s = self._s
        places = range(len(s))
        rate = [0.0] * len(s)
        self._rate(s, rate)
        total = rate[:]
        for part in (0.5, 0.5, 1.0):
            self._rate([s[i] + part * h * rate[i] for i in places], rate)
            # Runge-Kutta of fourth order, weights 1, 2, 2, 1, summed in the order of step.c.
            weight = 1.0 if part == 1.0 else 2.0
            total = [total[i] + weight * rate[i] for i in places]
        s[:] = [s[i] + h / 6.0 * total[i] for i in places]

    def _rate(self, s: list[float], rate: list[float]) -> None:
        self._rates(s=s, u=self._u, p=self._p, k=self._k, rate=rate)


def fingerprint(program: ModelCode) -> Fingerprint | None:
    """Return what the model's fixed run must give; None where Python cannot follow it, as with 1 / 0."""
    model = program.model
    step = round(2 * model.inner_step * _NS)
    inputs = {row.name: row.nominal for row in model.inputs}
    try:
        reference = ReferenceModel(program)
        reference.length = step / _NS
        bits = measure(reference, list(inputs.values()))
    except (ArithmeticError, ValueError):
        return None
    return Fingerprint(inputs, [row.name for row in program.outputs], step, bits)


def _compiled(block: Block) -> Callable[..., None]:
    arguments = dict.fromkeys((*block.reads, block.target))
    lines = [f"def {block.name}({', '.join(arguments)}):", "  pass"]
    lines += [f"  {name} = {value}" for name, value in body(block)]
    code = compile("\n".join(lines), f"<{block.name}>", "exec")
    names: dict[str, Any] = dict(_FUNCTIONS)
    # The text is our own generator's, of numbers, arrays and the functions below.
    exec(code, names)  # noqa: S102
    made: Callable[..., None] = names[block.name]
    return made


def _series(coefficients: Sequence[float], z: float) -> float:
    """Add up in pairs, fours and eights: the number of coefficients is a multiple of four."""
    y = z * z
    # Estrin's scheme, as in C: the order of the additions is part of the result.
    pairs = [z * odd + even for even, odd in zip(coefficients[::2], coefficients[1::2], strict=True)]
    fours = [y * odd + even for even, odd in zip(pairs[::2], pairs[1::2], strict=True)]
    total = fours[-1]
    for four in reversed(fours[:-1]):
        total = (y * y) * total + four
    return total


def _sine_core(x: float) -> float:
    z = x * x
    return x + x * z * _series(_SINE, z)


def _cosine_core(x: float) -> float:
    z = x * x
    return 1.0 - (0.5 * z - z * z * _series(_COSINE, z))


def _reduce(x: float) -> tuple[float, int]:
    # Adding and taking off 1.5 * 2^52 rounds to an integer without a call into libm.
    count = (x * 0.63661977236758134 + _MAGIC) - _MAGIC
    scaled = count - 4.0 * ((count * 0.25 + _MAGIC) - _MAGIC)
    # Cody and Waite: pi/2 in three parts, so that the first products are exact.
    high, middle, low = _PARTS
    return ((x - count * high) - count * middle) - count * low, int(scaled) & 3


def sine(x: float) -> float:
    """Return the sine, as c/elementary.h computes it."""
    rest, quarter = _reduce(x)
    value = _cosine_core(rest) if quarter & 1 else _sine_core(rest)
    return -value if quarter & 2 else value


def cosine(x: float) -> float:
    """Return the cosine, as c/elementary.h computes it."""
    rest, quarter = _reduce(x)
    value = _sine_core(rest) if quarter & 1 else _cosine_core(rest)
    return -value if quarter in {1, 2} else value


def angle(y: float, x: float) -> float:
    """Return the angle of the way (x, y), x above 0, as c/elementary.h computes it."""
    size = abs(y)
    if size <= x * 0.41421356237309503:  # tan(pi / 8)
        return _arc_tangent_core(y / x)
    if size <= x * 2.414213562373095:  # tan(3 pi / 8)
        value = 0.5 * _HALF_PI + _arc_tangent_core((size - x) / (size + x))
    else:
        value = _HALF_PI - _arc_tangent_core(x / size)
    return -value if y < 0.0 else value


def _arc_tangent_core(t: float) -> float:
    z = t * t
    return t + t * z * _series(_ARC_TANGENT, z)


def arc_tangent(x: float) -> float:
    """Return the arc tangent, as c/elementary.h computes it."""
    return angle(x, 1.0)


_FUNCTIONS: Final[dict[str, Callable[..., float]]] = {
    "sqrt": sqrt,
    "fabs": abs,
    "fb_sine": sine,
    "fb_cosine": cosine,
    "fb_arc_tangent": arc_tangent,
    "fb_angle": angle,
    "fb_square": lambda x: x * x,
    "fb_cube": lambda x: x * x * x,
    "fb_fourth": lambda x: (x * x) * (x * x),
    "fb_positive_part": lambda x: max(0.0, x),
    "fb_clamped": lambda x, bound: bound if x > bound else max(x, -bound),
    "fb_larger": max,
    "fb_step_at": lambda x: 1.0 if x > 0.0 else 0.0,
    "fb_reciprocal": lambda x: 1.0 / x,
}
