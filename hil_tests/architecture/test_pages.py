"""The pages that are made from the code's tables are those that lie in `docs/`."""

import importlib.util
from pathlib import Path
from types import ModuleType

import pytest

from firmware_bridge.wire.maxon.opcodes import ROWS, Opcode

ROOT = Path(__file__).parents[2]


def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_docs", ROOT / "tools/make_docs.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


MAKER = generator()
PAGES: dict[str, str] = dict(MAKER.made())
MARKED = {mark: MAKER.marked(mark) for mark in ("emergency", "opcode")}


@pytest.mark.parametrize("name", PAGES)
def test_a_made_page_is_as_make_docs_would_make_it(name: str) -> None:
    assert (ROOT / "docs" / name).read_text(encoding="utf-8") == PAGES[name], "run `make docs`"


def test_an_emergency_that_names_a_test_names_one_that_is_there() -> None:
    assert MARKED["emergency"][0x3220], "the page of emergencies finds its tests by their marks"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.name)
def test_every_serial_command_names_tests_that_go_through_it(row: Opcode) -> None:
    assert MARKED["opcode"].get(row.opcode), f"mark the tests of 0x{row.opcode:02X}"
