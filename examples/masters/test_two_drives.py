"""The master in Python: it turns two drives, and stops the one when the other has no power any more."""

import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.destructive

MASTER = (sys.executable, str(Path(__file__).with_name("two_drives.py")))


def test_both_turn_and_stand(bus, drives, under_test):
    drives("1-2", on=bus())
    master = under_test([*MASTER, *bus(), "1"])
    assert master.ends(within=60) == 0
    assert "both stand" in master.printed


def test_one_that_loses_its_power_stops_the_other(bus, drives, under_test):
    drives("1", on=bus())
    drives("2", on=bus())
    master = under_test([*MASTER, *bus(), "600"])
    master.prints("both turn", within=60)
    drives.lose_power("2")
    assert master.ends(within=20) == 1
    assert "silent: node 2; the other one stands" in master.printed
