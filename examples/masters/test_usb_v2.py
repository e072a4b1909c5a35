"""The master on a serial line: it moves a drive, and believes neither a damaged answer nor a bad one."""

import os
import sys
import tty
from pathlib import Path

import pytest

MASTER = (sys.executable, str(Path(__file__).with_name("usb_v2.py")))


@pytest.mark.destructive
def test_it_moves_the_drive_on_the_line_and_one_behind_it(drives, under_test):
    port = drives("1-2")
    for node in ("1", "2"):
        master = under_test([*MASTER, port, node, "8000"])
        assert master.ends(within=90) == 0
        assert abs(int(master.printed.split()[-1]) - 8000) < 50


@pytest.mark.destructive
def test_a_node_that_is_not_there_is_an_error(drives, under_test):
    master = under_test([*MASTER, drives("1"), "9", "8000"])
    assert master.ends(within=60) == 1
    assert "node 9 answers with error 0x05040000" in master.printed


def test_a_damaged_answer_is_not_believed(under_test):
    ours, theirs = os.openpty()
    tty.setraw(theirs)
    master = under_test([*MASTER, os.ttyname(theirs), "1", "8000"])
    os.read(ours, 64)
    os.write(ours, bytes.fromhex("90 02 00 04 00 00 00 00 40 01 00 00 2C C7"))  # true is 2C C6
    assert master.ends(within=60) == 1
    assert "wrong check sum" in master.printed
