"""Changes of the mutation campaign to a program: each way on a line of source, and the lines left alone."""

import ast
from pathlib import Path

import campaign
import pytest
from breaks import COUNTER, changes, is_tuned, names_in
from mutants import mutants, telling
from packages import hashes_of, targets
from packages import tests_of as files_for
from results import Result, read_reasons, read_results
from sample import drawn, new_lines


def broken(source: str) -> dict[str, str]:
    """Return what becomes of a piece of source by each change."""
    found: dict[str, str] = {}
    for place in range(len(list(ast.walk(ast.parse(source))))):
        tree = ast.parse(source)
        node = list(ast.walk(tree))[place]
        for way, (change, _) in enumerate(changes(node, names_in(tree))):
            tree = ast.parse(source)
            node = list(ast.walk(tree))[place]
            new = list(changes(node, names_in(tree)))[way][1](node)
            for parent in ast.walk(tree):
                for field, value in ast.iter_fields(parent):
                    if value is node:
                        setattr(parent, field, new)
                    elif isinstance(value, list) and node in value:
                        setattr(parent, field, [new if one is node else one for one in value])
            found[change] = ast.unparse(ast.fix_missing_locations(tree))
    return found


@pytest.mark.parametrize(
    ("source", "change", "becomes"),
    [
        ("a < b", "Lt -> LtE", "a <= b"),
        ("a < b", "Lt -> GtE", "a >= b"),
        ("a is b", "Is -> IsNot", "a is not b"),
        ("a and b", "And -> Or", "a or b"),
        ("a + b", "Add -> Sub", "a - b"),
        ("a << b", "LShift -> RShift", "a >> b"),
        ("not a", "without Not", "a"),
        ("-a", "without USub", "a"),
        ("True", "True -> False", "False"),
        ("7", "7 -> 8", "8"),
        ("7", "7 -> 6", "6"),
        ("2.0", "2.0 -> 2.02", "2.02"),
        ("min(a, b)", "min -> max", "max(a, b)"),
        ("any(a)", "any -> all", "all(a)"),
        ("a and b", "without operand 1", "b"),
        ("a or b or c", "without operand 2", "a or c"),
        ("min(a, b)", "argument 2 alone", "b"),
        ("f(a, b=c)", "without b", "f(a)"),
        ("(a, b, c)", "without element 2", "(a, c)"),
        ("{a: 1, b: 2}", "without element 1", "{b: 2}"),
        ("a if b else c", "always", "a if True else c"),
        ("a if b else c", "never", "a if False else c"),
        ("if a:\n    b()", "never", "if False:\n    b()"),
        ("for a in b:\n    c(a)", "the first one only", "for a in b:\n    c(a)\n    break"),
        ("self.a = b", "only the first time", f"if next({COUNTER}) == 0:\n    self.a = b"),
        ("x.a + x.b + y.c", "a -> b", "x.b + x.b + y.c"),
        ("abs(a) < b", "without abs", "a < b"),
        ("math.radians(a)", "radians -> degrees", "math.degrees(a)"),
        ("math.radians(a)", "without radians", "a"),
        ("to_seconds(a)", "without to_seconds", "a"),
        ("a * 1000", "without 1000", "a"),
        ("a // MILLISECOND", "without MILLISECOND", "a"),
        ("5 * SECOND", "SECOND -> MILLISECOND", "5 * MILLISECOND"),
        ("f(a, b.c)", "arguments 1 and 2 swapped", "f(b.c, a)"),
        ("f(a, 1, b)", "arguments 2 and 3 swapped", "f(a, b, 1)"),
        ("f(x=a, y=b)", "x and y swapped", "f(x=b, y=a)"),
        ("left - right", "left -> right", "right - right"),
        ("a.low_qc, a.high_qc", "low_qc -> high_qc", "(a.high_qc, a.high_qc)"),
        ("a['left'] + a['right']", "'left' -> 'right'", "a['right'] + a['right']"),
        ("if a:\n    b", "condition inverted", "if not a:\n    b"),
        ("a.b = c", "statement left out", "pass"),
        ("f(a)", "statement left out", "pass"),
        ("def f():\n    return a", "returns None", "def f():\n    return None"),
    ],
)
def test_each_way_to_break_a_line(source: str, change: str, becomes: str) -> None:
    assert broken(source)[change] == becomes


@pytest.mark.parametrize(
    "source",
    [
        "'a text'",
        "left",
        "a['left']",
        "x = isinstance(a, b)",
        "x = f(a, a)",
        "x = f('a', b)",
        "left = 'right'",
    ],
)
def test_what_no_one_could_notice_or_mistake_is_left_alone(source: str) -> None:
    kept = {change for change in broken(source) if change != "'right' -> 'left'"}
    assert kept == set()


def test_what_only_a_type_checker_reads_is_left_alone() -> None:
    assert [one for one in mutants("safety/snapshot") if "TypeVar" in one.code] == []


def test_what_has_no_order_is_not_swapped() -> None:
    assert not [change for change in broken("x = min(a, b)") if "swapped" in change]


def test_the_second_of_the_same_in_a_line_has_a_name_of_its_own() -> None:
    named = [one.key for target in ("safety/limits", "motion/ramp") for one in mutants(target)]
    assert len(named) == len(set(named))


def test_each_mutant_is_what_it_states_and_another_program() -> None:
    target = "motion/ramp"
    source = ast.unparse(ast.parse(Path("firmware_bridge/motion/ramp.py").read_text(encoding="utf-8")))
    made = [ast.unparse(one.tree()) for one in mutants(target)]
    assert source not in made
    assert len(set(made)) == len(made)


def test_a_module_that_reports_does_the_same_and_states_where_it_was() -> None:
    source = '''
def f(a):
    """Twice, or nothing."""
    if a:
        a = 2 * a
    else:
        return None
    return a
'''
    lines: list[int] = []
    space = {"__reached__": lines.append}
    exec(compile(telling(source), "it", "exec"), space)  # noqa: S102 - that is what is tested
    function = space["f"]
    assert function.__doc__ == "Twice, or nothing."
    assert function(3) == 6
    assert lines == [4, 5, 8]
    lines.clear()
    assert function(0) is None
    assert lines == [4, 7]


def test_the_rooms_have_modules_and_every_module_tests() -> None:
    every = list(targets())
    assert len(every) == len(set(every))
    packages = {target.partition("/")[0] for target in every}
    assert packages == {
        "safety",
        "bridge",
        "canopen",
        "canopen_drive",
        "families",
        "differential",
        "drivers",
        "motion",
        "robots",
        "diff_drive",
        "teleop",
        "mavlink",
    }
    without = [
        target for target in every if not all(file.exists() for file in files_for(target) or [Path("-")])
    ]
    assert without == []


def test_what_is_written_down_is_of_modules_that_there_are() -> None:
    every = set(targets())
    assert read_results().keys() <= every
    assert {module for module, _, _ in read_reasons()} <= every


def test_a_hash_is_of_what_is_done() -> None:
    assert hashes_of("motion/ramp") == hashes_of("motion/ramp")
    assert hashes_of("motion/ramp")[0] != hashes_of("motion/davis")[0]
    assert hashes_of("motion/ramp")[1:] == hashes_of("motion/davis")[1:]


def test_the_lines_that_a_difference_brings() -> None:
    assert new_lines("@@ -3 +4,2 @@ def f\n@@ -9,3 +12 @@\n@@ -20,2 +22,0 @@\n") == {4, 5, 12}


def test_a_sample_is_the_same_for_the_same_seed_and_within_its_budget() -> None:
    names = ("motion/ramp", "motion/davis", "motion/scissor")
    results = {name: Result("", "", "", 0, tests_ms=1000, mutant_ms=100, survived=()) for name in names}
    every = [one for name in names for one in mutants(name)]
    once = drawn(every, results, 1, 3000)
    assert once == drawn(every, results, 1, 3000)
    assert once != drawn(every, results, 2, 3000)
    modules = {one.target for one in once}
    assert 0 < len(modules) * 1000 + len(once) * 100 <= 3000
    assert drawn(every, results, 1, 900) == []


@pytest.mark.parametrize(
    ("source", "tuned"),
    [
        ("SILENT_MS: Final = 500", True),
        ("_QUIET_WITHIN: Final = 3", True),
        ("MOST_OPEN: Final = 64", True),
        ("AGREE: Final = 3", False),
        ("within = 3", False),
    ],
)
def test_what_someone_has_tuned_is_left_as_it_is(source: str, tuned: bool) -> None:  # noqa: FBT001
    assert is_tuned(ast.parse(source).body[0]) is tuned
    assert is_tuned(ast.parse("500 * MILLISECOND", mode="eval").body)


def test_a_test_is_found_by_its_name_however_often_a_process_collects_it(tmp_path: Path) -> None:
    file = tmp_path / "test_bytes.py"
    file.write_text(
        "import pytest\n"
        "@pytest.mark.parametrize('data', [b'\\\\x00', b'\\x01', b'a'], ids=str)\n"
        "def test_it(data): pass\n"
    )
    collected: list[list[str]] = []

    class Names:
        def pytest_collection_finish(self, session: pytest.Session) -> None:
            collected.append([item.nodeid for item in session.items])

    def runs() -> tuple[list[int], list[int]]:
        first = campaign._status([str(file)], Names())  # noqa: SLF001 - what a mutant's process does
        again = [
            campaign._status([str(file)], campaign._Order(collected[0], 1), Names())  # noqa: SLF001 - as above
            for _ in range(3)
        ]
        return [first, *again], [len(names) for names in collected]

    assert campaign.in_a_fork(runs) == ([0] * 4, [3] * 4)


def test_a_test_that_is_not_found_is_reported(tmp_path: Path) -> None:
    file = tmp_path / "test_one.py"
    file.write_text("def test_it(): pass\n")

    def lacks() -> list[str]:
        order = campaign._Order([f"{file}::test_gone[1]"], 1)  # noqa: SLF001 - what a mutant's process does
        campaign._status([str(file)], order)  # noqa: SLF001 - as above
        return order.lacks

    assert campaign.in_a_fork(lacks) == [f"{file}::test_gone"]
