"""Least delay at which pure pursuit swings about its path, [R] 5.2 to 5.4, 6.1 and App. B.

Ours is the pilot's own pursuit, and its critical delay. The independent ways are the eigenvalues of the
delayed equation, its delay cut into pieces, and a pursuit in closed form on a circle.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import Final

import numpy as np

from firmware_bridge.motion.model import Moving, Unicycle
from firmware_bridge.motion.pose import Pose
from firmware_bridge.pilot.paths import Path, circle, placed
from firmware_bridge.pilot.pursuit import Pursuit, critical_delay_s
from validation.studies.solve import Floats, root
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

RADIUS: Final = 5.0
SPEED: Final = 0.5
LOOK_AHEAD: Final = 0.5
CYCLE: Final = 0.050
"""s: a command is held so long, 5.3 and 6.1."""
FINE: Final = 0.010
"""s, of the independent way."""
DELAYS: Final = (0.0, 0.5, 0.55, 0.8)
PIECES: Final = 24
LONG_ENOUGH: Final = 200.0
LAST: Final = 20.0
"""s, at the end, in which the swing is looked at."""
RADIAL: Final = Pose(4.5, 0.0, 0.0)
"""[R] 5.3: half a meter inside the circle, looking out."""

HELD: Final = (
    "At 0.5 s, with the 25 ms of the hold, the loop is just above its critical delay: from either start a "
    "small swing remains."
)
IDEAL: Final = (
    "The robot here is ideal: at 0.8 s it circles with 0.25 m, where RARS needs 0.415 m. The whole "
    "chain, with steering that takes time, is driven by `bench rars --mission pursuit --link delay=0.8`."
)


def delay(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    lengths = (0.4, 0.5, 0.8) if quick else tuple(np.linspace(0.3, 1.2, 10))
    exact = {length: critical(SPEED, length) for length in (*lengths, LOOK_AHEAD)}
    fine = np.linspace(0.3, 1.2, 46)
    swings = {
        at: tuple(map(_swing, (_ours(at, RADIAL), closed(at, RADIAL), closed(at, RADIAL, hold=FINE))))
        for at in DELAYS
    }
    span = np.linspace(0.3, 0.8, 11 if quick else 26)
    return Findings(
        compared=(
            Compared(
                "critical delay about a line, 0.5 m/s, look-ahead 0.5 m",
                "s",
                None,
                exact[LOOK_AHEAD],
                critical_delay_s(SPEED, LOOK_AHEAD),
                1e-4,
                "(B.4) as printed lacks the heading and is unstable without delay: no number follows from it",
            ),
            *(
                Compared(
                    f"swing of the ideal robot at {at:g} s, start as in the thesis",
                    "mm",
                    None,
                    1e3 * independent,
                    1e3 * ours,
                    0.1,
                    f"held for 50 ms; {1e3 * smooth:.0f} mm where it is held for 10 ms only",
                )
                for at, (ours, independent, smooth) in swings.items()
            ),
        ),
        plots=(
            Plot(
                "Critical delay over the look-ahead, 0.5 m/s",
                "look-ahead L [m]",
                "delay of the whole loop [s]",
                (
                    Curve("pilot, closed form", fine, [critical_delay_s(SPEED, length) for length in fine]),
                    Curve(
                        "rightmost eigenvalue is 0", lengths, [exact[length] for length in lengths], "points"
                    ),
                ),
                "s² + (2 v / L s + 2 v² / L²) exp(-s tau) = 0, (B.4) corrected. Below the curve an "
                "offset decays, above it grows; a command that is held for 50 ms adds 25 ms to the delay.",
            ),
            Plot(
                "How fast an offset grows",
                "delay of the whole loop [s]",
                "growth rate [1/s]",
                (
                    *(
                        Curve(f"look-ahead {length:g} m", span, [growth(SPEED, length, at) for at in span])
                        for length in (0.4, 0.5, 0.8)
                    ),
                    Curve("neither grows nor decays", [span[0], span[-1]], [0.0, 0.0], "dashed"),
                ),
                "The largest real part of the characteristic equation's roots.",
            ),
            Plot(
                "Pure pursuit on the circle of 5 m, ideal robot",
                "time [s]",
                "distance from the center [m]",
                tuple(
                    Curve(f"delay {at:g} s", *_radius_over_time(_ours(at, RADIAL))) for at in (0.0, 0.5, 0.8)
                ),
                "v = 0.5 m/s, L = 0.5 m, from (4.5, 0) looking radially out, h2 = 0 (5.3): the "
                "look-ahead circle only touches the path there, so it is enlarged, by 1.1 (assumed). The "
                "robot does at once what it is commanded.",
            ),
            Plot(
                "The same, from above",
                "x [m]",
                "y [m]",
                tuple(
                    Curve(f"delay {at:g} s", *_ours(at, RADIAL)[: round(90.0 / CYCLE), :2].T)
                    for at in (0.0, 0.5, 0.8)
                ),
                "The first 90 s of the runs above.",
                equal=True,
            ),
        ),
        sheets=(
            Sheet(
                "Swing about the path in the last 20 s of 200 s, half of peak to peak",
                ("delay [s]", "start", "pilot's pursuit, 50 ms [mm]", "closed form, 10 ms [mm]"),
                tuple(
                    (
                        at,
                        name,
                        1e3 * _swing(_ours(at, start)),
                        1e3 * _swing(closed(at, start, hold=FINE)),
                    )
                    for at in DELAYS
                    for name, start in (
                        ("4.5 m, radially out", RADIAL),
                        ("10 mm beside the path, along it", Pose(4.99, 0.0, math.pi / 2.0)),
                    )
                ),
            ),
        ),
        remarks=(
            HELD,
            IDEAL,
        ),
    )


def growth(speed: float, look_ahead: float, delay_s: float, lag_s: float = 0.0) -> float:
    """Return the largest real part of the characteristic equation's roots in 1/s, without solving it.

    e' = v theta, theta' = - 2 v / L2 (e + L theta) at t - tau; with a lag theta' follows that by it.
    """
    now = np.array([[0.0, speed, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, -1.0 / lag_s if lag_s else 0.0]])
    late = np.zeros((3, 3))
    late[2 if lag_s else 1, :2] = -2.0 * speed / look_ahead**2 * np.array([1.0, look_ahead])
    states = 3 if lag_s else 2
    if lag_s:
        late /= lag_s
    return rightmost(now[:states, :states], late[:states, :states], delay_s)


def rightmost(now: Floats, late: Floats, delay_s: float) -> float:
    """Return the largest real part of the roots of x' = now x + late x(t - delay), 1/s.

    The way through the delay is a collocation on Chebyshev's points, and the roots are the eigenvalues of
    the whole.
    """
    states = len(now)
    places = np.cos(np.pi * np.arange(PIECES + 1) / PIECES)
    weights = np.r_[2.0, np.ones(PIECES - 1), 2.0] * (-1.0) ** np.arange(PIECES + 1)
    apart = places[:, None] - places[None, :]
    slopes = np.outer(weights, 1.0 / weights) / (apart + np.eye(PIECES + 1))
    slopes -= np.diag(slopes.sum(axis=1))
    whole = np.kron(2.0 / delay_s * slopes, np.eye(states))
    whole[:states] = 0.0
    whole[:states, :states] = now
    whole[:states, -states:] = late
    return float(np.linalg.eigvals(whole).real.max())


def critical(speed: float, look_ahead: float, lag_s: float = 0.0) -> float:
    """Return the delay in s at which nothing grows any more, by bisection."""
    time = look_ahead / speed
    return root(lambda at: growth(speed, look_ahead, at, lag_s), 0.01 * time, 1.2 * time)


@cache
def _ours(delay_s: float, start: Pose) -> Floats:
    """Return x, y and heading each 50 ms: the pilot's pursuit sees them late."""
    path = placed(circle(RADIUS), Pose(RADIUS, 0.0, math.pi / 2.0))
    return _driven(delay_s, start, CYCLE, lambda: _pilot(path))


def _pilot(path: Path) -> Callable[[Pose], float]:
    pursuit = Pursuit(path, LOOK_AHEAD)
    return lambda pose: pursuit.arc(pose).curvature_per_m


def _driven(
    delay_s: float, start: Pose, hold: float, driver: Callable[[], Callable[[Pose], float]]
) -> Floats:
    bends, model = driver(), Unicycle()
    late = round(delay_s / hold)
    moving, poses = Moving(start), [start]
    for place in range(round(LONG_ENOUGH / hold)):
        turn = SPEED * bends(poses[max(place - late, 0)])
        moving = model.step(moving, SPEED, turn, hold)
        poses.append(moving.pose)
    return np.array([(pose.x_m, pose.y_m, pose.heading_rad) for pose in poses])


@cache
def closed(delay_s: float, start: Pose, hold: float = CYCLE) -> Floats:
    """Return the same without the pilot: the goal by the cosine rule, the way in steps of 10 ms."""
    rows = [(start.x_m, start.y_m, start.heading_rad)]
    late, each, turn = round(delay_s / FINE), round(hold / FINE), 0.0
    for place in range(round(LONG_ENOUGH / FINE)):
        x, y, heading = rows[-1]
        if place % each == 0:
            turn = SPEED * bend(*rows[max(place - late, 0)])
        middle = heading + turn * FINE / 2.0
        way = SPEED * FINE
        rows.append((x + way * math.cos(middle), y + way * math.sin(middle), heading + turn * FINE))
    return np.array(rows)[:: round(CYCLE / FINE)]


def bend(x: float, y: float, heading: float, length: float = LOOK_AHEAD) -> float:
    """Return the curvature to the goal: r = l2 / (2 x) (5.5), left positive."""
    away = math.hypot(x, y)
    while length <= 1.01 * abs(away - RADIUS):
        length *= 1.1
    cosine = (away**2 + RADIUS**2 - length**2) / (2.0 * away * RADIUS)
    at = math.atan2(y, x) + math.acos(min(1.0, max(-1.0, cosine)))
    dx, dy = RADIUS * math.cos(at) - x, RADIUS * math.sin(at) - y
    return 2.0 * (dy * math.cos(heading) - dx * math.sin(heading)) / (dx * dx + dy * dy)


def _swing(rows: Floats) -> float:
    """Return half of peak to peak of the distance to the center in the last seconds, m."""
    last = rows[-round(LAST / CYCLE) :]
    return float(np.ptp(np.hypot(last[:, 0], last[:, 1]))) / 2.0


def _radius_over_time(rows: Floats) -> tuple[Floats, Floats]:
    shown = rows[: round(90.0 / CYCLE)]
    radius: Floats = np.hypot(shown[:, 0], shown[:, 1])
    return np.linspace(0.0, CYCLE * (len(shown) - 1), len(shown)), radius
