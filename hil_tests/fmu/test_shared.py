"""Shared and named terms of equations: each is computed once, as written; to all else it is its value."""

import math
import time
from typing import Any

import pytest
import sympy as sp

from fmu.export.blocks import ModelCode
from fmu.export.code import body
from fmu.export.documentation import documentation
from fmu.export.functions import named, shared
from fmu.export.model import Model, Output, StateVariable
from fmu.export.tangents import tangents
from fmu.parts.symbols import symbol
from fmu.plants import UNKNOWN, find

X, Y = symbol("x"), symbol("y")
TWIST = shared(X - Y)


def lines(rate: sp.Expr, other: sp.Expr) -> list[tuple[str, str]]:
    states = (StateVariable("x", "1", sp.S.Zero, rate), StateVariable("y", "1", sp.S.Zero, other))
    model = Model("two", "two", (), (), states, (Output("x", "1", "x", X),), 1e-3)
    return list(body(next(block for block in ModelCode(model).blocks if block.name == "rates")))


def test_a_shared_sum_is_not_taken_apart_by_the_sums_around_it() -> None:
    assert lines(TWIST + Y, TWIST - X) == [
        ("t0", "((s[0] - s[1]))"),
        ("rate[0]", "(s[1] + t0)"),
        ("rate[1]", "(t0 - s[0])"),
    ]


def test_without_it_sympy_takes_the_sum_apart() -> None:
    assert lines(X - Y + Y, X - Y - X) == [("rate[0]", "s[0]"), ("rate[1]", "(-s[1])")]


def test_its_slope_is_that_of_its_value() -> None:
    state = StateVariable("x", "1", sp.S.Zero, shared(3 * X) * X)
    model = Model(
        "one",
        "one",
        (),
        (),
        (state,),
        (Output("x", "1", "x", X),),
        1e-3,
    )
    rates = next(block for block in ModelCode(model).blocks if block.name == "rates")
    ((_, slope),) = tangents(rates).results
    known = dict(tangents(rates).shared)
    values = {sp.Symbol("s[0]", real=True): 2.0, sp.Symbol("ds[0]", real=True): 1.0}
    for name, value in known.items():
        values[name] = sp.sympify(value).xreplace(values).doit()
    found = slope.xreplace(values).replace(shared, lambda value: value)
    assert float(found) == 12.0  # d(3 x^2) at 2


def test_it_evaluates_to_its_value() -> None:
    assert sp.lambdify([X, Y], TWIST * 2)(5.0, 3.0) == 4.0


def nested(levels: int) -> Model:
    """Return a model whose rate has each level twice in the next one."""
    value = X
    for _ in range(levels):
        value = named(sp.sin(value) + value * Y)
    states = (StateVariable("x", "1", sp.S.Zero, value), StateVariable("y", "1", sp.S.Zero, -Y))
    return Model("nested", "nested", (), (), states, (Output("x", "1", "x", X),), 1e-3)


def test_parts_are_documented_once_where_they_would_fill_pages() -> None:
    (page,) = documentation(ModelCode(nested(16)), UNKNOWN).values()
    assert len(page) < 20_000
    assert "der(x) = named(part" in page
    assert "der(y) = -y" in page


def test_a_plant_takes_no_longer_a_second_time() -> None:
    """SymPy would compare the equal parts of both, each with all that it is made of."""
    taken = []
    for _ in range(2):
        begun = time.process_time()
        blocks = ModelCode(find("rome_arm").model()).blocks
        taken.append(time.process_time() - begun)
        for block in blocks[:4]:
            tangents(block)
    assert taken[1] < 3.0 * taken[0] + 1.0


def test_what_is_named_nests_as_deeply_as_it_likes() -> None:
    """Forty levels, each twice in the next, are forty lines, each behind what it is made of."""
    value = X
    for _ in range(40):
        value = named(sp.sin(value) + value * Y)
    written = lines(value, sp.S.Zero)
    assert 40 <= len(written) <= 200
    known: dict[str, Any] = {"s": [0.3, 0.2], "rate": [0.0, 0.0], "fb_sine": math.sin}
    for name, text in written:
        exec(f"{name} = {text}", known)  # noqa: S102 - our own generator's text
    expected = 0.3
    for _ in range(40):
        expected = math.sin(expected) + expected * 0.2
    assert known["rate"][0] == pytest.approx(expected, rel=1e-12)
