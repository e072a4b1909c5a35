"""Lines of any kind to the arm's sketch, and to a model of its grammar that shares no code with it."""

import pytest
from numpy.random import Generator, default_rng

from firmware_bridge.units import MICROSECOND, SECOND
from hil_tests.unit.arduino.ar2_bench import Bench
from hil_tests.unit.arduino.ar2_model import Model

WORDS = (*(4 * ["MJ"]), *("LL", "ML", "ON", "OF", "JF", "WI", "WO", "TM", "SV", "WT", "mj", "XX", "M", ""))
NOISE = "ABCDEFTSGHIKJLMX0123456789 .-+e"


def number(rng: Generator, most: int) -> str:
    shape = rng.integers(12)
    if shape == 0:
        return ""
    if shape == 1:
        return str(65_536 + int(rng.integers(most)))
    return ("-" if shape == 2 else "") + str(int(rng.integers(most)))


def move(rng: Generator, name: str) -> str:
    letters = "ABCDEFT" if name == "MJ" else "ABCDEF"
    fields = [f"{it}{rng.integers(3)}{number(rng, 60)}" for it in letters]
    speed = ("", "0", "1.3", "8", "25", "99.5", "1e2", "250", "-5", ".5")[rng.integers(10)]
    fields.append(f"S{speed}")
    if name == "MJ":
        fields += [f"{it}{number(rng, 100)}" for it in "GHIK"]
    for _ in range(rng.integers(3)):
        what = rng.integers(4)
        place = int(rng.integers(len(fields)))
        if what == 0:
            fields.pop(place)
        elif what == 1:
            rng.shuffle(fields)
        elif what == 2:
            fields.insert(place, fields[int(rng.integers(len(fields)))])
        else:
            fields[place] += NOISE[rng.integers(len(NOISE))]
    return name + "".join(fields)


def points(rng: Generator) -> str:
    """Return points as the GUI sends them: the first on the line of the count, often with a wrong count."""
    count = int(rng.integers(5))
    few = "\n".join(move(rng, "MJ").replace("T1", "T0") for _ in range(count + 1))
    return f"ML{count}{few}" if rng.integers(4) else f"ML{rng.integers(-2, 1)}"


def line(rng: Generator) -> str:
    name = WORDS[rng.integers(len(WORDS))]
    if name in {"MJ", "LL"}:
        return move(rng, name)
    if name == "ML":
        return points(rng)
    if name == "WT":
        return f"WTS{rng.integers(30)}.{rng.integers(100)}"
    if name in {"ON", "OF", "JF", "WI", "WO"}:
        return f"{name}{'XN'[name[0] == 'W']}{rng.integers(2, 54)}{'T3' * int(rng.integers(2))}"
    noise = "".join(NOISE[it] for it in rng.integers(len(NOISE), size=rng.integers(20)))
    return name + ("-" * (name == "M")) + noise


def agree(seed: int, count: int) -> int:
    """Send lines to both; return the number of pulses that both have made."""
    rng, bench, pulses = default_rng(seed), Bench(), 0
    model = Model(list(bench.joints.places))
    for _ in range(count):
        for text in line(rng).split("\n"):
            begun = bench.begun
            stated = bench.ask(text.encode() + b"\n", 200 * SECOND)
            meant = model.obey(text + "\n")
            assert bench.busy == (meant is None), text
            assert meant is None or stated == meant, text
            kept = [(axis, ahead, (at - begun // MICROSECOND)) for axis, ahead, at in bench.kept]
            assert kept == model.pulses, text
            pulses += len(kept)
            # What was lost at a stop is no matter of the grammar.
            model.places[:] = bench.joints.places
            if meant is None:
                bench, model = Bench(), Model(list(Bench().joints.places))
                break
    return pulses


def test_some_hundred_lines_are_answered_and_done_as_the_model_does() -> None:
    assert agree(1, 300) > 5_000


@pytest.mark.long(beside="test_some_hundred_lines_are_answered_and_done_as_the_model_does")
def test_ten_thousand_lines_are_answered_and_done_as_the_model_does() -> None:
    assert agree(2, 10_000) > 100_000
