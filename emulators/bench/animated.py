"""A page that plays a run's path: the robot's place, speed and active interlocks, by a slider over time.

It needs no other file and no network: rows of the table as JSON, and a few lines of script.
"""

import json
import math
from collections.abc import Mapping, Sequence
from html import escape
from typing import Final

from emulators.bench.columns import ODOMETRY, POSE, Samples
from emulators.bench.summary import InterlockEntry
from emulators.bench.web import document

EVERY: Final = 5
"""Step through the table's rows: 20 per second."""
LOOK: Final = """
svg { width: 100%; height: 60vh; background: #fafafa; border: 1px solid #ddd }
polyline { fill: none; stroke-linejoin: round } input { width: 100% }
#events { color: #a00; min-height: 3em } button { font: inherit; width: 6em }
"""
BODY: Final = """<h1>{title}</h1>
<svg id="map" viewBox="{box}" role="img" aria-label="path"><g transform="scale(1,-1)">
<polyline id="way" stroke="#bbb" stroke-width="{thin}"/>
<polyline id="gone" stroke="#0072b2" stroke-width="{thick}"/>
<polygon id="robot" fill="#009e73" points="{robot}"/></g></svg>
<p><button id="play">play</button> <span id="state"></span></p>
<input id="at" type="range" min="0" value="0" step="1" aria-label="time">
<p id="events"></p><p class="pale">{of}; x ahead at the start, y to the left, m</p>
<script>const run = {data};{script}</script>"""
SCRIPT: Final = """
const by = id => document.getElementById(id), last = run.at.length - 1;
const points = end => run.x.slice(0, end).map((x, i) => x + "," + run.y[i]).join(" ");
by("way").setAttribute("points", points(last + 1));
by("at").max = last;
function show(i) {
  by("gone").setAttribute("points", points(i + 1));
  const turned = run.heading[i] * 180 / Math.PI;
  by("robot").setAttribute("transform", `translate(${run.x[i]},${run.y[i]}) rotate(${turned})`);
  const now = run.at[i], state = run.armed[i] ? "armed" : "not armed";
  by("state").textContent = `${now.toFixed(2)} s, ${run.speed[i].toFixed(3)} m/s, ${state}`;
  by("events").textContent = run.events.filter(h => h.from <= now && (h.to === null || now < h.to))
    .map(h => h.text).join("; ");
}
let playing = null;
function stop() { clearInterval(playing); playing = null; by("play").textContent = "play"; }
by("at").oninput = () => show(+by("at").value);
by("play").onclick = () => {
  if (playing !== null) return stop();
  if (+by("at").value === last) by("at").value = 0;
  const begun = performance.now(), from = run.at[+by("at").value];
  by("play").textContent = "pause";
  playing = setInterval(() => {
    const now = from + (performance.now() - begun) / 1000;
    let i = +by("at").value;
    while (i < last && run.at[i + 1] <= now) i++;
    by("at").value = i; show(i);
    if (i === last) stop();
  }, 50);
};
show(0);
"""


def animated(title: str, samples: Samples, events: Sequence[InterlockEntry]) -> str:
    """Return the page of a run; rows before the robot knew where it was are left out."""
    rows = _rows(samples)
    box, span = _box(rows["x"], rows["y"])
    held = [{"from": it.began_s, "to": it.ended_s, "text": it.reason or it.name} for it in events]
    data = json.dumps({**rows, "events": held}, separators=(",", ":"), allow_nan=False)
    long, wide = 0.03 * span, 0.012 * span
    body = BODY.format(
        title=escape(title),
        box=box,
        thin=f"{0.004 * span:.4g}",
        thick=f"{0.008 * span:.4g}",
        robot=f"{long:.4g},0 {-long:.4g},{wide:.4g} {-long:.4g},{-wide:.4g}",
        of="by the plant" if samples.truth else "by the bridge's odometry",
        # A text with "</script>" in it must not end the page's script.
        data=data.replace("</", "<\\/"),
        script=SCRIPT,
    )
    return document(title, body, LOOK)


def _rows(samples: Samples) -> Mapping[str, list[float]]:
    names = POSE if samples.truth else ODOMETRY
    # JSON has no NaN: rows before the pose is known are left out.
    kept = [
        row for row in samples[::EVERY] if all(math.isfinite(row[name]) for name in (*names, "speed_mps"))
    ]
    columns = dict(zip(("x", "y", "heading"), names, strict=True)) | {"speed": "speed_mps", "armed": "armed"}
    table = {key: [round(row[name], 4) for row in kept] for key, name in columns.items()}
    return {"at": [round(row.at / 1e9, 2) for row in kept], **table}


def _box(xs: Sequence[float], ys: Sequence[float]) -> tuple[str, float]:
    """Return the view box around a path, y downwards there, and how far it reaches, m."""
    (left, right), (low, high) = ((min(it, default=0.0), max(it, default=0.0)) for it in (xs, ys))
    span = max(right - left, high - low, 0.2)
    margin = 0.08 * span
    wide, tall = right - left + 2 * margin, max(high - low, 0.3 * span) + 2 * margin
    middle = (low + high) / 2
    return f"{left - margin:.4g} {-middle - tall / 2:.4g} {wide:.4g} {tall:.4g}", span
