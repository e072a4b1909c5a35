"""The first seconds of every mission are the same bytes everywhere: kernel, reference, any interpreter.

Where a change is meant to change them: `make golden`.
"""

import hashlib
import importlib.util
import lzma
import sys
from pathlib import Path
from types import ModuleType

import pytest

from emulators.servo import kernel

ROOT = Path(__file__).parents[2]
MEANT = "\nmeant? then `make golden`"
MOST_BYTES = 1 << 20
"""Limit of all kept packets: they travel with every clone."""


def tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("golden_traces", ROOT / "tools/golden_traces.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # a dataclass looks its module up there
    spec.loader.exec_module(module)
    return module


TOOL = tool()
GOLDEN: dict[str, str] = TOOL.golden()
SERVOS = [
    pytest.param(
        kernel.NATIVE,
        marks=pytest.mark.skipif(kernel.find().library is None, reason="the kernel is not built here"),
    ),
    kernel.REFERENCE,
]


def kept(name: str) -> bytes:
    return lzma.decompress(TOOL.kept(name).read_bytes())


def links(lines: bytes) -> set[str]:
    return {line.split()[1].decode() for line in lines.splitlines()}


def test_there_is_one_for_the_plant_and_each_mission_and_link() -> None:
    names = {f"mission {name}" for name in TOOL.missions()}
    names |= {f"mission {name}, {link}" for name in TOOL.missions() for link in links(kept(name))}
    assert set(GOLDEN) == {f"plant {TOOL.ROBOT}"} | names
    assert len(set(GOLDEN.values())) == len(GOLDEN)


@pytest.mark.parametrize("name", TOOL.missions())
def test_the_packets_that_are_kept_are_those_of_the_hashes(name: str) -> None:
    lines = kept(name)
    assert hashlib.sha256(lines).hexdigest() == GOLDEN[f"mission {name}"]
    for link in links(lines):
        own = b"".join(line for line in lines.splitlines(keepends=True) if line.split()[1].decode() == link)
        assert hashlib.sha256(own).hexdigest() == GOLDEN[f"mission {name}, {link}"]


def test_what_is_kept_stays_small_and_complete() -> None:
    files = sorted(TOOL.FOLDER.glob("*.trace.xz"))
    assert files == sorted(TOOL.kept(name) for name in TOOL.missions())
    assert sum(file.stat().st_size for file in files) < MOST_BYTES


def test_the_plants_equations_give_the_golden_bits() -> None:
    assert TOOL.plant() == GOLDEN[f"plant {TOOL.ROBOT}"], MEANT


@pytest.mark.long(keeps=["faults-native", "interlocks-native"])
@pytest.mark.parametrize("servo", SERVOS)
@pytest.mark.parametrize("name", TOOL.missions())
def test_a_mission_begins_as_it_always_did(name: str, servo: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(kernel.VARIABLE, servo)
    driven = TOOL.drive(name)
    if not driven.hashes.items() <= GOLDEN.items():
        pytest.fail(TOOL.difference(driven) + MEANT, pytrace=False)


def test_a_change_shows_its_first_packet_in_words() -> None:
    name = TOOL.missions()[0]
    lines = kept(name)
    assert TOOL.difference(TOOL.Driven(name, lines, {})) == ""
    begin = lines.index(b" can right 00000282 ", len(lines) // 2)
    end = lines.index(b"\n", begin)
    low = slice(end - 4, end - 2)  # of the current in mA, the last of what is mapped
    other = f"{int(lines[low], 16) ^ 1:02x}".encode()
    reported = TOOL.difference(TOOL.Driven(name, lines[: low.start] + other + lines[low.stop :], {}))
    head, *context, expected, came = reported.splitlines()
    number = lines[:begin].count(b"\n") + 1
    assert head == f"mission {name}: packet {number} is the first that differs"
    assert len(context) == 5
    milliamperes = []
    for line, word in ((expected, "expected  "), (came, "but came  ")):
        assert line.startswith(word)
        assert " s  can  right  282#" in line
        assert "  TPDO 2, node 2: 0x6041 Statusword = 0x" in line
        current = line.rsplit("0x2027 Current Actual Value Averaged = ", 1)[1]
        milliamperes.append(int(current.removesuffix(" mA")))
    assert milliamperes[0] ^ 1 == milliamperes[1]


def test_a_run_that_ends_early_states_what_is_missing() -> None:
    name = TOOL.missions()[0]
    lines = kept(name)
    short = lines[: lines.rindex(b"\n", 0, len(lines) - 1) + 1]
    reported = TOOL.difference(TOOL.Driven(name, short, {}))
    assert reported.endswith("but came  nothing more")
