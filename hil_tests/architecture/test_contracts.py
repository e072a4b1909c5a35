"""Contracts that import-linter cannot say: the wire's imports, no test code in the product, file sizes."""

import ast
import sys
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("firmware_bridge", "emulators", "fmu")
LONGEST_FILE = 400


def sources(*folders: str) -> list[Path]:
    return sorted(path for folder in folders for path in (ROOT / folder).rglob("*.py"))


@cache
def parsed(path: Path) -> ast.Module:
    return ast.parse(path.read_text(encoding="utf-8"))


def imports(path: Path) -> Iterator[str]:
    for statement in ast.walk(parsed(path)):
        if isinstance(statement, ast.Import):
            yield from (alias.name for alias in statement.names)
        elif isinstance(statement, ast.ImportFrom):
            assert statement.level == 0, f"{path}: a relative import hides its layer"
            yield statement.module or ""


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def test_the_words_on_the_wire_need_the_standard_library_only() -> None:
    below = ("node", "packet", "units", "canopen", "wire")
    own = tuple(f"firmware_bridge.{module}" for module in below)
    strange = [
        (name(path), module)
        for path in sources("firmware_bridge/canopen", "firmware_bridge/wire")
        for module in imports(path)
        if module.split(".")[0] not in sys.stdlib_module_names and not module.startswith(own)
    ]
    assert strange == []


def test_the_product_does_not_know_its_tests() -> None:
    tests = {"hil_tests", "hypothesis", "pytest"}
    knows = {name(it) for it in sources(*PACKAGES) if tests & {word.split(".")[0] for word in imports(it)}}
    # A plugin of pytest's, and tests that every robot gets: nothing of ours imports them.
    assert knows == {"emulators/testing/plugin.py", "emulators/testing/inherited/test_robot.py"}


def test_every_module_states_what_it_is_for() -> None:
    stated = {name(path): ast.get_docstring(parsed(path)) or "" for path in sources(*PACKAGES)}
    assert [path for path, text in stated.items() if not text.partition("\n")[0].endswith(".")] == []


def test_a_file_that_outgrows_its_page_is_two_files() -> None:
    files = sources(*PACKAGES, "benchmarks", "examples", "hil_tests", "tools")
    lines = {name(path): len(path.read_text(encoding="utf-8").splitlines()) for path in files}
    assert {path: count for path, count in lines.items() if count > LONGEST_FILE} == {}


def test_one_place_sleeps_and_one_module_reads_a_clock() -> None:
    allowed = {"firmware_bridge/runtime", "emulators/run.py"}
    readers = {name(path) for path in sources(*PACKAGES) if "time" in imports(path)}
    assert {path for path in readers if not path.startswith(tuple(allowed))} == set()


PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
CONTRACTS = PROJECT["tool"]["importlinter"]["contracts"]


def test_every_contract_has_an_id_of_its_own() -> None:
    # import-linter takes two of one id, and a search finds the last of them only.
    ids = [contract["id"] for contract in CONTRACTS]
    assert [name for name in ids if ids.count(name) > 1] == []


def test_every_package_has_its_place_in_the_contracts() -> None:
    contracts = {contract["id"]: contract for contract in CONTRACTS}
    assert contracts["drive"]["exhaustive"]
    assert contracts["bridge"]["exhaustive"]
    assert contracts["emulators"]["exhaustive"]
    assert contracts["epos2"]["exhaustive"]
    assert contracts["arduino"]["exhaustive"]
    assert set(PROJECT["tool"]["importlinter"]["root_packages"]) == {*PACKAGES, "validation"}
