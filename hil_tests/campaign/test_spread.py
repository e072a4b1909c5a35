"""Work over processes: equal results for any number, and through the death of a process."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from emulators.campaign.spread import TRIES, Processes, SpreadError, in_order, spread


def squared(number: int) -> int:
    return number * number


def dies_once(folder: str, number: int) -> int:
    """Kill this process the first time that it has the number 5."""
    mark = Path(folder) / "died"
    if number == 5 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def dies(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def refuses(number: int) -> int:
    if number == 4:
        raise ValueError("four")
    return number


@pytest.mark.parametrize("jobs", [1, 2, 4])
def test_results_come_in_the_order_of_the_items(jobs: int) -> None:
    assert list(in_order(squared, range(20), jobs)) == [number**2 for number in range(20)]


def test_nothing_is_lost_or_done_twice_as_a_process_dies(tmp_path: Path) -> None:
    found = list(spread(partial(dies_once, str(tmp_path)), list(range(20)), 2))
    assert (tmp_path / "died").exists()
    assert sorted(found) == [(number, number) for number in range(20)]


def test_an_item_that_kills_every_process_ends_it_with_a_message() -> None:
    with pytest.raises(SpreadError, match=f"its process has died {TRIES} times"):
        list(spread(dies, list(range(8)), 2))


def test_processes_take_work_again_and_again() -> None:
    with Processes(2) as processes:
        first = {dict(processes.results(process_of, range(4)))[0] for _ in range(5)}
    assert len(first) <= 2


def process_of(_: int) -> int:
    return os.getpid()


@pytest.mark.parametrize("jobs", [1, 2])
def test_what_the_work_raises_is_raised(jobs: int) -> None:
    with pytest.raises(ValueError, match="four"):
        list(in_order(refuses, range(40), jobs))


PACKAGE = """
from emulators.campaign.spread import in_order
def work(number): return number
if __name__ == "__main__":
    print(list(in_order(work, [1, 2], 1)))
"""


def test_a_function_of_a_package_s_main_is_refused_before_a_process_dies_of_it(tmp_path: Path) -> None:
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "__main__.py").write_text(PACKAGE, encoding="utf-8")
    ended = subprocess.run(
        [sys.executable, "-m", "mine"], cwd=tmp_path, check=False, capture_output=True, text=True
    )
    assert ended.returncode == 1
    assert "work: move it from mine.__main__ into a module of its own" in ended.stderr


@pytest.mark.long(beside="test_results_come_in_the_order_of_the_items")
@pytest.mark.parametrize(
    "line", ["adversary rars --hours 0.001 --jobs 2", "stability usual --count 26 --jobs 2"]
)
def test_the_searches_run_in_two_processes(line: str) -> None:
    words = [sys.executable, "-P", "-m", f"hil_tests.{line.split(maxsplit=1)[0]}", *line.split()[1:]]
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    ended = subprocess.run(words, check=False, capture_output=True, text=True, env=environment)
    assert "its process has died" not in ended.stderr
    assert "0 found" in ended.stdout or "26 of 26: 0 tip with the governor" in ended.stdout, ended.stderr


WAITS = """
import sys, time
from hil_tests.campaign.test_spread import waits
from emulators.campaign.spread import spread
if __name__ == "__main__":
    list(spread(waits, [sys.argv[1] + "/a", sys.argv[1] + "/b"], 2))
"""


def waits(place: str) -> None:
    Path(place).write_text(str(os.getpid()), encoding="ascii")
    while True:
        signal.pause()


def alive(pid: int) -> bool:
    try:
        state = Path(f"/proc/{pid}/stat").read_text(encoding="ascii").rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def test_processes_end_with_the_one_that_began_them(tmp_path: Path) -> None:
    (tmp_path / "main.py").write_text(WAITS, encoding="utf-8")
    environment = os.environ | {"PYTHONPATH": str(Path(__file__).parents[2])}
    above = subprocess.Popen([sys.executable, str(tmp_path / "main.py"), str(tmp_path)], env=environment)
    places, deadline = [tmp_path / "a", tmp_path / "b"], time.monotonic() + 60.0
    while not all(place.exists() and place.read_text(encoding="ascii") for place in places):
        assert time.monotonic() < deadline, "they did not begin"
        assert above.poll() is None
        os.sched_yield()
    below = [int(place.read_text(encoding="ascii")) for place in places]
    assert all(map(alive, below))
    above.kill()
    above.wait()
    while any(map(alive, below)):
        assert time.monotonic() < deadline, "they go on alone"
        os.sched_yield()
