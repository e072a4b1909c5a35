"""The pages that are made from the code's tables are those that lie in `docs/`."""

import importlib.util
from pathlib import Path
from types import ModuleType

from firmware_bridge.families.epos2.maxon.opcodes import ROWS

ROOT = Path(__file__).parents[2]


def generator() -> ModuleType:
    spec = importlib.util.spec_from_file_location("make_docs", ROOT / "tools/make_docs.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


MAKER = generator()


def test_each_made_page_is_as_make_docs_would_make_it() -> None:
    for name, text in MAKER.made().items():
        assert (ROOT / "docs" / name).read_text(encoding="utf-8") == text, "run `make docs`"


def test_an_emergency_that_names_a_test_names_one_that_is_there() -> None:
    assert MAKER.marked("emergency")[0x3220], "the page of emergencies finds its tests by their marks"


def test_every_serial_command_names_tests_that_go_through_it() -> None:
    marked = MAKER.marked("opcode")
    assert [f"mark the tests of 0x{row.opcode:02X}" for row in ROWS if not marked.get(row.opcode)] == []
