"""Manoeuvres that may tip RARS over: drawn by a seed, driven on the bench with the plant that tips over.

It starts on the level with its lift down, and drives onto a slope while the operator moves the stick, lifts
and stops as chance has it. In some it stops on the slope, lifts its empty table as far as it may, and is
loaded there, or its load is shifted: that is what tips on slopes that it drives on safely. Slope, its
direction and the payload are the plant's; the bridge knows the slope by its IMU, the payload by the heaviest
of the robot file.
"""

import math
import tomllib
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np

from firmware_bridge.robot import AnyRobot
from firmware_bridge.robot_types import parse, robots
from hil_tests.scenarios.ride import ARMED, SETTLED_S, STANDS, Ride, ride, step, story

STEEPEST_RAD: Final = math.radians(25.0)
HARD_RAD: Final = (math.radians(28.0), math.radians(30.0))
"""Slopes of the hard ones: up to 25 degrees the robot's own limit of 0.144 g nearly always holds."""
HEAVIEST_KG: Final = 10.0
LASTS_S: Final = 8.0
"""From arming on."""
LOADED: Final = 0.2
"""Share of the manoeuvres in which it is loaded with its table up."""
LIFTS_S: Final = 20.0
PARTS: Final = 10
"""A load is put on within a second: one that drops makes the wheels give way, and the bridge take power."""
SHIFTED_M: Final = 0.05
"""Largest shift of a load, ahead and to a side."""
BEGINS_S: Final = 4.0
EVERY_S: Final = 0.1
"""The plant's slope is moved in such steps."""
GRIPS: Final = 1.0
BALANCE: Final = """
[geometry.balance]
pitch = "pitch"
roll = "roll"
mass_kg = 70.6
scissor_kg = 8.0
table_height_m = 0.5
payload_kg = 10.0
floor_friction = 1.0
payload_aside_m = 0.071
"""


WEIGHED: Final = """
[[sensors]]
name = "ahead"
title = "specific force ahead, m/s2"
link = "imu"
every_ms = 50
silent_ms = 100
settings = { quantity = "acceleration_x" }

[geometry.balance.weighing]
acceleration = "ahead"
newton_per_ampere = 19.7
resistance_n = 8.5
"""
"""38 mN.m/A by 26:1 on a radius of 50 mm; what it needs on the level is measured on the bench."""


def robot(*, governed: bool, weighed: bool = False) -> AnyRobot:
    """RARS by set 2.3.1 with an IMU and the plant that tips over, with the governor or without it.

    Its wheels may give way by 50 mm/s before that is `uncommanded motion`: where a slope rises by 30 degrees
    in a second they do by 35 mm/s, and without power it would roll.
    """
    files = robots()
    text = files["rars"].read_text(encoding="utf-8")
    text = text.replace('fmu = "rars"', 'fmu = "rars_tipping"')
    text = text.replace("[geometry.lift]", "centre_offset_m = 0.141\n\n[geometry.lift]", 1)
    imu = files["rars"].with_name("imu.toml").read_text(encoding="utf-8")
    text = text.replace("{ friction = 0.33 }", "{ friction = 0.33, speed = 1.0 }")
    tables = (BALANCE if governed else "", WEIGHED if weighed else "")
    made = parse("\n".join((text, imu, *tables)), "tipping.toml")
    plant = made.plant.model_copy(update={"parameters": {"floor_friction": GRIPS}})
    return made.model_copy(update={"plant": plant})


@dataclass(frozen=True, slots=True)
class SeedList:
    """A list of manoeuvres, seeds from 0 on."""

    hard: bool
    count: int
    of_1000: int
    """So many of 1,000 tip over without the governor, at least."""
    in_make_test: int
    in_long_lane: int
    found: tuple[int, ...]
    """Seeds that tipped over with a governor as it was once."""


LISTS: Final = {
    name: SeedList(**{**row, "found": tuple(row["found"])})
    for name, row in tomllib.loads(Path(__file__).with_name("lists.toml").read_text(encoding="utf-8")).items()
}


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """One of them, whole."""

    seed: int
    payload: tuple[tuple[float, dict[str, float]], ...]
    """What of the plant's load changes, each with its instant after arming."""
    slope_rad: float
    heading_rad: float
    """Where uphill is, from where the robot looked at its start."""
    enters_s: float
    within_s: float
    """Time from the level to the whole slope."""
    stick: tuple[tuple[float, dict[str, float | str]], ...]
    """What the operator does, each with its instant."""
    lasts_s: float = LASTS_S
    """From arming on."""


def drawn(seed: int, *, hard: bool = False) -> Manoeuvre:
    """Return the manoeuvre of a seed; a hard one is near the limits of tipping."""
    chance = np.random.default_rng([seed, int(hard)])
    steep = HARD_RAD if hard else (0.0, STEEPEST_RAD)
    # Hard with the nose uphill: its rear wheels are near its centre of mass.
    heading = float(chance.normal(0.0, 0.2) if hard else chance.uniform(-math.pi, math.pi))
    payload_kg = float(chance.uniform(0.8 if hard else 0.0, 1.0)) * HEAVIEST_KG
    made = Manoeuvre(
        seed=seed,
        payload=((0.0, {"lift_payload": payload_kg}),),
        slope_rad=float(chance.uniform(*steep)),
        heading_rad=heading,
        enters_s=float(chance.uniform(4.5, 6.5)),
        within_s=float(chance.uniform(0.8, 2.0)),
        stick=tuple(_stick(chance, hard=hard)),
    )
    return made if hard or chance.random() > LOADED else _loaded(chance, made)


def _loaded(chance: np.random.Generator, made: Manoeuvre) -> Manoeuvre:
    """Return a manoeuvre in which it stops, lifts its empty table, and is loaded there."""
    stops_s = made.enters_s + made.within_s
    done_s = stops_s + 1.5 + LIFTS_S
    ahead, left = chance.uniform(-SHIFTED_M, SHIFTED_M, 2)
    steepness, load = chance.uniform(0.85, 1.0), chance.uniform(0.8, 1.0)
    return replace(
        made,
        slope_rad=float(steepness) * STEEPEST_RAD,
        payload=(
            (0.0, {"lift_payload": 0.0}),
            *(
                (done_s + part / PARTS, {"lift_payload": part / PARTS * float(load) * HEAVIEST_KG})
                for part in range(1, PARTS + 1)
            ),
            (done_s + 1.0, {"payload_ahead": float(ahead), "payload_left": float(left)}),
        ),
        stick=(
            # Straight on: it looks as it was drawn, and no emergency stop keeps its table down.
            (BEGINS_S, {"speed_mps": 0.3, "steer_deg": 0.0}),
            (round(stops_s, 2), {"speed_mps": 0.0, "steer_deg": 0.0}),
            (round(stops_s + 1.5, 2), {"speed_mps": 0.0, "lift_rate_mps": 0.1}),
        ),
        lasts_s=done_s + 3.0,
    )


def _stick(chance: np.random.Generator, *, hard: bool) -> Iterator[tuple[float, dict[str, float | str]]]:
    at, way = BEGINS_S, 1.0
    while at < BEGINS_S + LASTS_S - 1.0:
        share = chance.uniform(-1.0, 1.0)
        # Full stick is as frequent as a draw between: hands push to the end.
        speed = 0.5 * (math.copysign(1.0, share) if chance.random() < 0.5 else share)
        does: dict[str, float | str] = {"speed_mps": float(speed)}
        if chance.random() < 0.5:
            does["steer_deg"] = float(chance.uniform(-58.0, 58.0))
        kind = chance.random()
        if hard and kind > 0.2:
            # Backwards, and at once ahead: the longest push against its rear wheels.
            way = -way
            does = {"speed_mps": 0.5 * way, "steer_deg": 0.0}
        elif kind < 0.15:
            does |= {"speed_mps": 0.0, "lift_rate_mps": 0.1}
        elif kind < 0.3:
            does["speed_mps"] = 0.0
        elif kind < 0.35:
            does = {"press": "emergency_stop"}
        yield round(at, 2), does
        at += float(chance.uniform(0.9, 1.8) if hard else chance.uniform(0.4, 1.8))


class Driver:
    """Drives one manoeuvre after the other, each from the moment at which the robot has just been armed."""

    def __init__(self, machine: AnyRobot) -> None:
        self._ride: Final = ride(ARMED, seconds=2.0 * BEGINS_S, robot=machine)
        self._ride.runs_until(SETTLED_S)
        if self._ride.now["armed"] != 1.0:
            raise RuntimeError(f"the robot is not armed: {sorted(self._ride.holding)}")
        self._moment: Final = self._ride.rig.snapshot()

    def tips(self, one: Manoeuvre) -> bool:
        """Return whether the robot tips over."""
        ridden = self._begun(one)
        plant = ridden.rig.devices.plant
        waiting = list(one.payload)
        plant.change("slope_heading", one.heading_rad)
        for name in ("payload_ahead", "payload_left"):
            plant.change(name, 0.0)
        for number in range(round(one.lasts_s / EVERY_S)):
            at = SETTLED_S + number * EVERY_S
            share = min(max((at - one.enters_s) / one.within_s, 0.0), 1.0)
            plant.change("slope", share * one.slope_rad)
            while waiting and waiting[0][0] <= at:
                for name, value in waiting.pop(0)[1].items():
                    plant.change(name, value)
            ridden.runs(EVERY_S)
            if plant.read("tipped"):
                return True
        return False

    def finish(self) -> None:
        """Let go of the plant."""
        self._ride.rig.finish()

    def _begun(self, one: Manoeuvre) -> Ride:
        rig = self._ride.rig
        rig.restore(self._moment)
        lines = [line.wire for line in rig.lines.values()]
        for wire in (*rig.can_wires.values(), *lines, rig.operator_wire):
            wire.unobserved()
        steps = (step(at, **does) for at, does in one.stick)
        self._ride.operator.take_over(story(STANDS, ARMED, *steps, seconds=BEGINS_S + one.lasts_s))
        return self._ride
