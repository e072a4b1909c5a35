"""The first seconds of every mission are the same bytes here as everywhere: kernel, twin, any interpreter.

Where a change is meant to change them: `make golden`.
"""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from emulators.servo import kernel

ROOT = Path(__file__).parents[2]


def tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("golden_traces", ROOT / "tools/golden_traces.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


TOOL = tool()
GOLDEN: dict[str, str] = TOOL.golden()
SERVOS = [
    pytest.param(
        kernel.NATIVE,
        marks=pytest.mark.skipif(kernel.find().library is None, reason="the kernel is not built here"),
    ),
    kernel.TWIN,
]


def test_there_is_one_for_the_plant_and_each_mission() -> None:
    names = {f"mission {name}" for name in TOOL.missions()}
    assert set(GOLDEN) == {f"plant {TOOL.ROBOT}"} | names
    assert len(set(GOLDEN.values())) == len(GOLDEN)


def test_the_plants_equations_give_the_golden_bits() -> None:
    assert TOOL.plant() == GOLDEN[f"plant {TOOL.ROBOT}"], "meant? then `make golden`"


@pytest.mark.parametrize("servo", SERVOS)
@pytest.mark.parametrize("name", TOOL.missions())
def test_a_mission_begins_as_it_always_did(name: str, servo: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(kernel.VARIABLE, servo)
    assert TOOL.trace(name) == GOLDEN[f"mission {name}"], "meant? then `make golden`"
