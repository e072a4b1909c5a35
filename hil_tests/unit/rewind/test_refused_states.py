"""States that are left alone, and states that cannot be kept: those are refused, with their place."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from emulators.rewind import External, NotCaptured, Rewind, RewindError
from hil_tests.unit.rewind.boxes import Box, Frozen
from hil_tests.unit.rewind.digest import digest


def test_what_is_outside_is_left_alone(tmp_path: Path) -> None:
    with (tmp_path / "log").open("w") as file:
        box = Box(number=1, observers=External([file.write]))
        rewind = Rewind(box)
        moment = rewind.snapshot()
        box.observers.append(print)
        box.number = 2
        rewind.restore(moment)
        assert box.number == 1
        assert len(box.observers) == 2


class Hidden(NotCaptured):
    """Stands for a class whose state is forgotten."""

    def __init__(self) -> None:
        self.count = 0


def test_a_state_that_is_forgotten_shows_in_the_digest() -> None:
    box = Box(hidden=Hidden())
    rewind = Rewind(box)
    before, moment = digest(box), rewind.snapshot()
    box.hidden.count = 1
    rewind.restore(moment)
    assert digest(box) != before


class Stubborn:
    """A keeper that gives nothing away."""

    def save_state(self) -> object:
        raise RuntimeError("not now")

    def restore_state(self, _: Any) -> None:
        raise RuntimeError("never")


def test_a_keeper_that_refuses_leaves_everything_as_it_is() -> None:
    class Once(Stubborn):
        def save_state(self) -> object:
            return None

    box = Box(number=1, keeper=Once())
    rewind = Rewind(box)
    moment = rewind.snapshot()
    box.number = 2
    with pytest.raises(RuntimeError, match="never"):
        rewind.restore(moment)
    assert box.number == 2
    with pytest.raises(RuntimeError, match="not now"):
        Rewind(Box(keeper=Stubborn())).snapshot()


def endless() -> Any:
    while True:
        yield 1


@pytest.mark.parametrize(
    ("made", "name"),
    [
        (endless, "generator"),
        (lambda: iter([1, 2]), "list_iterator"),
        (lambda: map(abs, [1]), "map"),
        (lambda: Path(__file__).open(), "TextIOWrapper"),  # noqa: SIM115 - it is never read
        (lambda: memoryview(bytearray(3)), "memoryview"),
    ],
)
def test_a_state_that_no_one_sees_is_refused_with_its_place(made: Callable[[], Any], name: str) -> None:
    hidden = made()
    box = Box(inner=Box(table={"key": [Frozen(Box(task=hidden), abs)]}))  # type: ignore[arg-type] # any callable
    rewind = Rewind(box)
    for _ in range(2):
        with pytest.raises(RewindError, match=rf"{name} has a state.*Box\.inner > Box\.table.*Box\.task"):
            rewind.snapshot()
    box.inner.table["key"].clear()
    rewind.snapshot()
    box.inner.table["key"].append(hidden)
    with pytest.raises(RewindError, match=name):
        rewind.snapshot()
    if hasattr(hidden, "close"):
        hidden.close()


def test_after_a_refusal_nothing_is_taken_for_known() -> None:
    """Objects found on the way to the refusal, and those behind them, are looked for again."""
    box = Box(things=[])
    rewind = Rewind(box)
    rewind.snapshot()
    box.things.append(Box(first=[1], hidden=endless(), last=[2]))
    with pytest.raises(RewindError):
        rewind.snapshot()
    box.things[0].hidden = None
    before, moment = digest(box), rewind.snapshot()
    box.things[0].first.append(0)
    box.things[0].last.append(0)
    rewind.restore(moment)
    assert digest(box) == before
