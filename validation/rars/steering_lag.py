"""The critical delay where the steering itself lags, [R] App. B (B.2), Fig. B.1.

Ours is the pilot's closed form. The independent ways are the eigenvalues of the delayed equation, and a robot
that is driven on a line below and above the delay.
"""

import math
from typing import Final

import numpy as np

from firmware_bridge.pilot.pursuit import critical_delay_s
from validation.rars.delay import critical
from validation.studies.solve import Floats
from validation.studies.study import Compared, Curve, Findings, Plot, Sheet

LAGS: Final = (0.0, 0.05, 0.1, 0.2, 0.3)
"""s, at n = v / L = 1 1/s."""
RATIOS: Final = (1.5, 2.0, 3.0, 5.0, 10.0)
"""L / (v T), the axis of Fig. B.1."""
FINE: Final = 1e-3
SHARES: Final = (0.97, 1.03)
LONG_S: Final = 120.0
LAG: Final = 0.1


def steering_lag(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study; a quick one is the same."""
    del quick
    ratios = np.linspace(1.05, 10.0, 60)
    return Findings(
        compared=(
            *(
                Compared(
                    f"critical delay, v / L = 1 1/s, lag {lag:g} s",
                    "s",
                    None,
                    critical(1.0, 1.0, lag),
                    critical_delay_s(1.0, 1.0, lag),
                    1e-5,
                )
                for lag in LAGS
            ),
            *(
                Compared(
                    f"critical delay over the lag, L / (v T) = {ratio:g}",
                    "1",
                    None,
                    critical(1.0, ratio, 1.0),
                    critical_delay_s(1.0, ratio, 1.0),
                    1e-4,
                    "Fig. B.1 was not available: its axis, no value of it",
                )
                for ratio in RATIOS
            ),
        ),
        plots=(
            Plot(
                "Critical delay over the look-ahead, both by the steering's lag (Fig. B.1)",
                "L / (v T) [1]",
                "critical delay / T [1]",
                (
                    Curve("pilot, closed form", ratios, [critical_delay_s(1.0, one, 1.0) for one in ratios]),
                    Curve(
                        "rightmost eigenvalue is 0",
                        RATIOS,
                        [critical(1.0, one, 1.0) for one in RATIOS],
                        "points",
                    ),
                ),
                "T s³ + s² + (2 n s + 2 n²) exp(-s tau) = 0, n = v / L, (B.2) with the heading. Where the "
                "look-ahead is v T or less it swings without any delay.",
            ),
            Plot(
                "An offset on a line, just below and just above the critical delay",
                "time [s]",
                "distance from the line [mm]",
                tuple(Curve(f"{share:g} of the critical delay", *_shown(driven(share))) for share in SHARES),
                f"n = 1 1/s, lag {LAG:g} s, from 10 mm beside the line; integrated in steps of 1 ms.",
            ),
        ),
        sheets=(
            Sheet(
                "Largest offset in the last 12 s over that in 12 s before the middle",
                ("share of the critical delay", "ratio [1]"),
                tuple((share, grown(share)) for share in SHARES),
            ),
        ),
    )


def driven(share: float) -> Floats:
    """Return the offset from the line each ms, m, at a share of the critical delay."""
    late = round(share * critical_delay_s(1.0, 1.0, LAG) / FINE)
    offset, heading, turn = 0.010, 0.0, 0.0
    wanted = [0.0] * late
    offsets = [offset]
    for _ in range(round(LONG_S / FINE)):
        wanted.append(-2.0 * (offset + heading))
        turn += (wanted[-1 - late] - turn) * -math.expm1(-FINE / LAG)
        heading += turn * FINE
        offset += heading * FINE
        offsets.append(offset)
    return np.array(offsets)


def grown(share: float) -> float:
    """Return by how much the offset has grown in the second half."""
    offsets, part = np.abs(driven(share)), round(12.0 / FINE)
    middle = len(offsets) // 2
    return float(offsets[-part:].max() / offsets[middle - part : middle].max())


def _shown(offsets: Floats) -> tuple[Floats, Floats]:
    return FINE * np.arange(len(offsets), dtype=float)[::20], 1e3 * offsets[::20]
