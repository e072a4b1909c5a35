"""Divisions by powers of one value become one division; others stay as they are."""

import pytest
import sympy as sp

from fmu.export.reciprocals import with_reciprocals

T, U, S = sp.symbols("t0 t1 s", real=True)
SHARED = ((T, S + 2), (U, T**-3 + S))


def value(lines: tuple[tuple[sp.Expr, sp.Expr], ...], result: sp.Expr, s: float) -> float:
    known = {S: sp.Float(s)}
    for symbol, expression in lines:
        known[symbol] = expression.xreplace(known)
    return float(result.xreplace(known))


def divisions(*expressions: sp.Expr) -> int:
    return sum(power.exp.is_negative is True for one in expressions for power in one.atoms(sp.Pow))


def test_several_powers_of_one_value_are_divided_by_once() -> None:
    results = [S / T + U, 3 / T**2]
    lines, changed = with_reciprocals(SHARED, results)
    assert [str(symbol) for symbol, _ in lines] == ["t0", "r0", "t1"]
    assert divisions(*(expression for _, expression in lines), *changed) == 1
    for before, after in zip(results, changed, strict=True):
        assert value(lines, after, 0.7) == pytest.approx(value(SHARED, before, 0.7), rel=1e-14)


def test_a_value_that_comes_from_an_array_is_divided_by_before_all_else() -> None:
    lines, changed = with_reciprocals((), [1 / S, 2 / S**2])
    assert [str(symbol) for symbol, _ in lines] == ["r0"]
    assert divisions(*changed) == 0


def test_a_single_division_and_roots_stay_as_they_are() -> None:
    results = [S / T, 1 / sp.sqrt(U)]
    shared = ((T, S + 2), (U, S + 3))
    assert with_reciprocals(shared, results) == (shared, results)
