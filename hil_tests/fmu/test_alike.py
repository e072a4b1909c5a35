"""Parts that there are several copies of: marks change no value, and copies run side by side."""

from pathlib import Path

import pytest
import sympy as sp

from fmu.build import export
from fmu.export.alike import AlikeError, Copy, apart, plain
from fmu.export.blocks import Program
from fmu.export.code import generate
from fmu.export.functions import clamped, larger, positive_part, reciprocal, size
from fmu.export.model import Expression, Model, Output, State
from fmu.parts.symbols import symbol
from fmu.plant import FmuPlant
from fmu.verify import Verdict
from hil_tests.fmu.model_bench import OWN

VERSION = "{alike}"
X, Y = symbol("x"), symbol("y")


def rate(name: str, value: Expression) -> Expression:
    """Use each function that copies may use side by side."""
    copy = Copy("ball", name)
    value = copy.takes("value", value)
    curved = clamped(value**3, sp.Rational(3, 4)) * reciprocal(1 + sp.sqrt(size(value) + value**4))
    return copy.gives("rate", curved - larger(value, sp.Rational(1, 8)) + positive_part(-value) ** 2)


def model(count: int) -> Model:
    names = [f"s{n}" for n in range(count)]
    states = [State(name, "1", sp.S.Zero, rate(name, symbol(name) + n)) for n, name in enumerate(names)]
    outputs = [Output(name, "1", name, symbol(name)) for name in names]
    return Model("balls", "balls", (), (), tuple(states), tuple(outputs), 1e-3)


@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_any_number_of_copies_is_compiled_to_the_bits_of_its_equations(tmp_path: Path, count: int) -> None:
    target = tmp_path / "balls.fmu"
    export(model(count), 3, target, token=VERSION)
    names = [f"s{n}" for n in range(count)]
    with FmuPlant(target, (), names, units={}) as plant:
        assert plant.fingerprint is Verdict.SAME
        function = sp.lambdify(
            [symbol(name) for name in names], [s.rate for s in model(count).states], [OWN, "math"]
        )
        for _ in range(10):
            plant.step()
        expected = function(*plant.outputs)
        assert [plant.read(f"der({name})") for name in names] == pytest.approx(expected, rel=1e-14)


def test_copies_are_written_in_pairs_and_in_turn() -> None:
    text = generate(Program(model(4)), VERSION)["model.c"]
    written = [line.split()[2] for line in text.splitlines() if line.startswith("  const fb_lanes ball_")]
    assert written[:4] == ["ball_value_0", "ball_value_1", "ball_rate_0", "ball_rate_1"]


def test_a_mark_is_its_value() -> None:
    one = Copy("ball", "one")
    marked = one.gives("sum", one.takes("x", X + 1) * 2)
    assert plain([marked, marked * Y]) == [2 * X + 2, (2 * X + 2) * Y]
    assert marked.free_symbols == {X}


def test_copies_that_are_not_alike_are_refused() -> None:
    one, other = Copy("ball", "one"), Copy("ball", "other")
    with pytest.raises(AlikeError, match="ball gives y by another equation in other than in others"):
        apart([one.gives("y", one.takes("x", X) + 1), other.gives("y", other.takes("x", Y) + 2)])


def test_copies_that_wait_for_each_other_are_refused() -> None:
    one, other = Copy("ball", "one"), Copy("ball", "other")
    first = one.gives("y", one.takes("x", X) + 1)
    second = other.gives("y", other.takes("x", first) + 1)
    states = (State("x", "1", sp.S.Zero, second),)
    waiting = Model("balls", "balls", (), (), states, (Output("x", "1", "x", X),), 1e-3)
    with pytest.raises(AlikeError, match="take what depends on what others of them give"):
        Program(waiting).blocks  # noqa: B018 - made when asked for
