"""The master in C: it moves a drive that it has to itself, and gives up where the drive has a fault."""

import subprocess
from pathlib import Path

import pytest

pytestmark = [pytest.mark.needs("vcan", "cc"), pytest.mark.destructive]


@pytest.fixture
def master(tmp_path):
    source, program = Path(__file__).with_name("cia402.c"), tmp_path / "cia402"
    subprocess.run(["cc", "-O2", "-Wall", "-Wextra", "-Werror", "-o", program, source], check=True)
    return program


@pytest.mark.parametrize("family", ["epos2", "cia402"])
def test_it_moves_a_drive(master, bus, drives, under_test, family):
    channel = drives("1-2", on=bus(), family=family)
    moves = under_test(f"{master} {channel} 2 8000")
    assert moves.ends(within=90) == 0
    assert "node 2: enabled" in moves.printed
    at = int(moves.printed.split()[-1])
    assert abs(at - 8000) < 50


def test_it_gives_up_where_the_load_is_too_heavy(master, bus, drives, under_test):
    channel = drives("1", "--load", "0.05,0.01", on=bus())
    moves = under_test(f"{master} {channel} 1 200000")
    assert moves.ends(within=90) == 1
    assert "fault, emergency 0x8611, not there" in moves.printed
