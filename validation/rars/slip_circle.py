"""RARS round a circle of 5 m on tyres that slip, [R] 3.4.5, Fig. 3.12 to 3.19.

Its wheels are driven by a servo of 5 N.m.s/rad to the speeds of a circle without slip, its front wheels stand
for that circle. Ours is the plant; the independent way is written apart: a rigid body on four contacts, whose
rear spins follow at once from servo and tyre.
"""

import math
from collections.abc import Callable
from typing import Final, NamedTuple

import numpy as np

from firmware_bridge.motion import davis
from firmware_bridge.motion.tables import DavisBase
from firmware_bridge.robot_types import find
from validation.rars.plant import PLAIN, STEP, WHEELS, P, Plant
from validation.rars.torques import LASTS, RADIUS, turned_by
from validation.studies.solve import Floats, integrate
from validation.studies.study import Compared, Curve, Findings, Plot

SERVO: Final = 5.0
"""N.m.s/rad at the wheel, assumed."""
KINGPINS: Final = 0.400
"""m: c = l / 2 on either side, the source's own assumption in 3.4.4."""
RIM: Final = P["wheel_radius"]
HALF: Final = P["rear_track"] / 2.0
LONG: Final = P["wheelbase"]
AHEAD: Final = P["centre_offset"]
PLATFORM: Final = P["platform_mass"]
TOTAL: Final = PLATFORM + 2.0 * P["wheel_mass"]
SLOW: Final = 0.02
"""m/s under which a slip is taken over this speed: in the plant half of it, with bristles."""
SAMPLES: Final = 121
SUBSTEPS: Final = 1_000
"""Of 0.5 ms: at rest the tyres are stiff."""
REACHED_S: Final = 20.0
LAPS_S: Final = 35.0
"""Of the circle at a constant speed: up to it, and at it."""
SLIPPERY: Final = 0.1
COMMANDED: Final = (2.20, 2.26, 2.30, 2.34)
"""m/s: the softness of the servo takes some hundredths of each."""
PRINT: Final = (
    "no value of Tab. 3.1 gives the print; servo, slip angles in rad and no load transfer are assumed here"
)


class Rounds(NamedTuple):
    """One circle: times in s, places in m, headings in rad from the start's."""

    times: Floats
    x: Floats
    y: Floats
    turned: Floats

    @property
    def off(self) -> Floats:
        """How far it is off the circle of the rear axle's middle, m."""
        return np.hypot(self.x, self.y) - RADIUS


class Row(NamedTuple):
    """One quantity of a circle; the prints by friction."""

    what: str
    unit: str
    printed: dict[float, float]
    within: float
    of: Callable[[Rounds], float]


ROWS: Final = (
    Row("end, x", "m", {0.3: 4.862}, 0.002, lambda one: float(one.x[-1])),
    Row("end, y", "m", {0.3: -1.166}, 0.002, lambda one: float(one.y[-1])),
    Row("angle that it turns by", "°", {0.3: 350.0}, 0.1, lambda one: math.degrees(one.turned[-1])),
    Row("largest distance from the circle", "m", {}, 0.002, lambda one: float(np.abs(one.off).max())),
)


def slip_circle(quick: bool) -> Findings:  # noqa: FBT001 - every study takes it
    """Make the study."""
    frictions = (0.3,) if quick else (0.3, 0.1)
    ours = {friction: _driven(friction) for friction in frictions}
    apart = {friction: _apart(friction) for friction in frictions}
    round_it = np.linspace(0.0, math.tau, 181)
    return Findings(
        compared=(
            *(() if quick else (_skid(),)),
            *(
                Compared(
                    f"{row.what}, mu = {friction:g}",
                    row.unit,
                    row.printed.get(friction),
                    row.of(apart[friction]),
                    row.of(ours[friction]),
                    row.within,
                    PRINT,
                )
                for friction in frictions
                for row in ROWS
            ),
        ),
        plots=(
            Plot(
                "Path of the rear axle's middle",
                "x [m]",
                "y [m]",
                (
                    Curve("circle", RADIUS * np.cos(round_it), RADIUS * np.sin(round_it), "dashed"),
                    *(Curve(f"plant, mu = {mu:g}", one.x, one.y) for mu, one in ours.items()),
                    *(
                        Curve(f"written apart, mu = {mu:g}", one.x[::6], one.y[::6], "points")
                        for mu, one in apart.items()
                    ),
                ),
                "Fig. 3.12 and 3.16: it ends inside the circle, the more the less the floor grips.",
                equal=True,
            ),
            Plot(
                "Distance from the circle",
                "time [s]",
                "outwards [m]",
                (
                    *(Curve(f"plant, mu = {mu:g}", one.times, one.off) for mu, one in ours.items()),
                    *(
                        Curve(f"written apart, mu = {mu:g}", one.times[::6], one.off[::6], "points")
                        for mu, one in apart.items()
                    ),
                ),
                "beta(t) of (3.41), T = 60 s: 0.98 m/s half way round.",
            ),
            Plot(
                "Turned less than commanded",
                "time [s]",
                "commanded less actual angle [°]",
                tuple(
                    Curve(f"plant, mu = {mu:g}", one.times, np.degrees(_commanded(one.times) - one.turned))
                    for mu, one in ours.items()
                ),
                "Fig. 3.13 to 3.19 show slip ratios and yaw rate; none of the source's figures is at hand.",
            ),
        ),
        remarks=(PRINT,),
    )


def _skid() -> Compared:
    return Compared(
        "speed at which it leaves the circle, mu = 0.1",
        "m/s",
        None,
        math.sqrt(SLIPPERY * P["gravity"] * RADIUS),
        skid_speed(),
        0.03,
        "sqrt(mu g R); in print it skids at 0.79 m/s, which no value of Tab. 3.1 gives",
    )


def _commanded(times: Floats) -> Floats:
    return np.array([turned_by(float(at))[0] for at in times])


def _speeds(at: float) -> tuple[float, float]:
    """Return the rear wheels' speeds without slip, rad/s."""
    rate = turned_by(at)[1]
    return (RADIUS - HALF) * rate / RIM, (RADIUS + HALF) * rate / RIM


def _steering() -> DavisBase:
    base: DavisBase = find("rars").geometry.base
    return base.model_copy(update={"kingpin_distance_m": KINGPINS})


def _driven(
    friction: float, speeds: Callable[[float], tuple[float, float]] = _speeds, lasts: float = LASTS
) -> Rounds:
    """Return what the plant drives, its wheels driven to these speeds in rad/s for so many seconds."""
    base = _steering()
    pinion = davis.pinion_from_steer(base, davis.steer_from_curvature(base, 1.0 / RADIUS))
    given = {
        **PLAIN,
        "floor_friction": friction,
        "cg_height": 0.0,
        "friction_circle": 0.0,
        "kingpin_distance": KINGPINS,
        "coulomb_steer": 50.0,
        "angle_steer": pinion * P["gear_steer"],
        "x": RADIUS,
        "heading": math.pi / 2.0,
    }
    steps = round(lasts * 1e9 / STEP)
    kept = []
    with Plant(**given) as plant:
        for step in range(steps + 1):
            if step % (steps // (SAMPLES - 1)) == 0:
                kept.append((plant["x"], plant["y"], plant["heading"] - math.pi / 2.0))
            wanted = speeds(step * STEP / 1e9)
            turning = [plant[f"speed_{side}"] / P[f"gear_{side}"] for side in WHEELS]
            plant.turn(*(SERVO * (want - has) for want, has in zip(wanted, turning, strict=True)))
    x, y, turned = np.array(kept).T
    return Rounds(np.linspace(0.0, lasts, SAMPLES), x, y, turned)


def held(speed: float, friction: float = SLIPPERY) -> tuple[float, float]:
    """Return speed in m/s and radius in m, commanded a speed on the circle that is reached slowly."""

    def speeds(at: float) -> tuple[float, float]:
        rate = speed / RADIUS * min(at / REACHED_S, 1.0)
        return (RADIUS - HALF) * rate / RIM, (RADIUS + HALF) * rate / RIM

    one = _driven(friction, speeds, LAPS_S)
    last = one.times > LAPS_S - 5.0
    passed = np.diff(one.times[last])
    moving = float((np.hypot(np.diff(one.x[last]), np.diff(one.y[last])) / passed).mean())
    return moving, moving / float((np.diff(one.turned[last]) / passed).mean())


def skid_speed() -> float:
    """Return the speed in m/s at which it is carried out of the circle by 1 % of its radius."""
    speeds, radii = zip(*(held(speed) for speed in COMMANDED), strict=True)
    return float(np.interp(1.01 * RADIUS, radii, speeds))


def _apart(friction: float) -> Rounds:
    """Return what the equations drive that are written apart."""
    base = _steering()
    inner = davis.steer_from_curvature(base, 1.0 / RADIUS)
    outer = davis.outer_from_rack(base, davis.rack_from_steer(base, inner))
    front = ((KINGPINS / 2.0, inner), (-KINGPINS / 2.0, outer))
    gravity = P["gravity"]
    rear_load = gravity * (PLATFORM * (1.0 - AHEAD / LONG) + 2.0 * P["wheel_mass"]) / 2.0
    front_load = gravity * PLATFORM * AHEAD / LONG / 2.0
    inertia = (
        P["yaw_inertia"]
        + 2.0 * P["wheel_yaw_inertia"]
        + PLATFORM * AHEAD**2
        + 2.0 * P["wheel_mass"] * HALF**2
    )
    moment = PLATFORM * AHEAD
    matrix = np.linalg.inv(np.array([[TOTAL, 0.0, 0.0], [0.0, TOTAL, moment], [0.0, moment, inertia]]))

    def grip(slip: float) -> float:
        size = abs(slip)
        peak = P["peak_slip"]
        share = size / peak if size < peak else 1.0 - 0.34 * (min(size, 1.0) - peak) / (1.0 - peak)
        return math.copysign(friction * share, slip)

    def aside(along: float, across: float, load: float) -> float:
        return -load * grip(math.atan2(across, max(abs(along), SLOW)))

    def pushed(wanted: float, along: float) -> float:
        """Return the tyre's force ahead where servo and tyre agree on the spin, by bisection."""
        low, high = -friction * rear_load, friction * rear_load
        for _ in range(25):
            force = (low + high) / 2.0
            rim = RIM * wanted - force * RIM**2 / SERVO
            held = rear_load * grip((rim - along) / max(abs(rim), abs(along), SLOW))
            low, high = (force, high) if held > force else (low, force)
        return force

    def rates(at: float, state: Floats) -> Floats:
        _, _, heading, ahead, left, turning = state
        fx = fy = mz = 0.0
        for side, wanted in zip((HALF, -HALF), _speeds(at), strict=True):
            along = ahead - turning * side
            push, hold = pushed(wanted, along), aside(along, left, rear_load)
            fx, fy, mz = fx + push, fy + hold, mz - push * side
        for side, angle in front:
            vx, vy = ahead - turning * side, left + turning * LONG
            cosine, sine = math.cos(angle), math.sin(angle)
            hold = aside(vx * cosine + vy * sine, vy * cosine - vx * sine, front_load)
            fx, fy = fx - hold * sine, fy + hold * cosine
            mz += LONG * hold * cosine + side * hold * sine
        # In the robot's axes, which turn with it.
        forces = np.array(
            [
                fx + TOTAL * left * turning + moment * turning**2,
                fy - TOTAL * ahead * turning,
                mz - moment * ahead * turning,
            ]
        )
        cosine, sine = math.cos(heading), math.sin(heading)
        place = (ahead * cosine - left * sine, ahead * sine + left * cosine, turning)
        return np.array((*place, *(matrix @ forces)))

    times = np.linspace(0.0, LASTS, SAMPLES)
    start = np.array([RADIUS, 0.0, math.pi / 2.0, 0.0, 0.0, 0.0])
    x, y, heading = integrate(rates, start, times, SUBSTEPS).T[:3]
    return Rounds(times, x, y, heading - math.pi / 2.0)
