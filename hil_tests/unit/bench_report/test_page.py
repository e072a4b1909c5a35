"""A run on one page: the first things that a reader needs are there, and nothing is fetched for it."""

import re
import sys
from pathlib import Path

import pytest

from emulators.bench.page import page
from emulators.bench.records import FaultRecord, InterlockEvent
from emulators.bench.summary import Summary, summarize
from emulators.bench.web import document, picture, table
from firmware_bridge.cli.program import main
from firmware_bridge.units import SECOND
from hil_tests.unit.bench_report.test_summary import AXES, RUN, rows

AGAIN = "firmware-bridge bench rars --mission line --seed 7"


def summary() -> Summary:
    events = [InterlockEvent("lift extended", "50 mm & more", SECOND, 2 * SECOND, remedy="lower it first")]
    faults = [FaultRecord("frame_loss", "a <loose> contact", ("steer",), SECOND)]
    return summarize(RUN, AXES, rows(11, lambda _: 0.1), events, faults)


def test_it_states_what_was_measured_what_held_what_was_wrong_and_how_to_run_it_again(tmp_path: Path) -> None:
    drawn = tmp_path / "path.png"
    drawn.write_bytes(b"\x89PNG")
    text = page(summary(), {"max_speed_mps": "limit 0.5"}, [drawn], AGAIN)
    for stated in (
        *("rars, line, seed 7", AGAIN, "largest speed", "limit 0.5", "lift extended", "50 mm &amp; more"),
        *("lower it first", "1.00 s", "2.00 s", "frame_loss", "a &lt;loose&gt; contact", "steer", ">end<"),
        'alt="path" src="data:image/png;base64,iVBORw=="',
    ):
        assert stated in text, stated


def test_what_was_not_is_stated_too() -> None:
    text = page(summarize(RUN, AXES, rows(11, lambda _: 0.1), []), {}, [], AGAIN)
    assert text.count("<p>none</p>") == len(("holds", "faults"))


def test_a_page_needs_no_other_file() -> None:
    text = document("a & b", table(("x", "y"), [("<1>", "2")], (1,)) + picture(b"x", "png", 'a "b"'))
    assert "<title>a &amp; b</title>" in text
    assert '<td>&lt;1&gt;</td><td class="number">2</td>' in text
    assert 'alt="a &quot;b&quot;"' in text
    assert re.findall(r'(?:src|href)="(?!data:|#)', text) == []
    assert "<script" not in text


def test_bench_leaves_its_page_with_the_line_that_was_typed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    mission = tmp_path / "short one.toml"
    mission.write_text(
        'title = "short"\nduration_s = 0.5\n[[step]]\nat_s = 0.1\ntitle = "arm"\narm = true\n',
        encoding="utf-8",
    )
    words = ["bench", "rars", "--mission", str(mission), "--out", str(tmp_path / "run")]
    monkeypatch.setattr(sys, "argv", ["/somewhere/firmware-bridge", *words])
    with pytest.raises(SystemExit) as ended:
        main()
    assert ended.value.code in {0, None}
    text = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert f"<code>firmware-bridge bench rars --mission &#x27;{mission}&#x27; --out" in text
    assert text.count("<figure>") == len(list((tmp_path / "run").glob("*.png")))
