"""Evenings drawn at random: what operators do, and what fails, from tables; a mission like any other."""

import math
from collections.abc import Callable, Iterator
from itertools import repeat
from typing import Annotated, Any, Final, Literal, get_args, get_origin

import numpy as np
from numpy.random import Generator

from emulators.bench.bench_setup import BenchSetup
from emulators.bench.faults import Fault, kinds, misfits, read
from emulators.bench.faults.people import BridgeEnds
from emulators.bench.faults.site import BRIDGE
from emulators.bench.foreign_datagrams import Stray
from emulators.bench.mission import Mission, Noise
from emulators.bench.step import Holds, Input, Presses, Sends, Slope, Step, inputs, modes, path_followers
from firmware_bridge.robot import AnyRobot
from fmu.plants import find as find_plant
from hil_tests.adversary.degraded import Degraded
from hil_tests.adversary.failing import FAILING, FaultProfile, disables_power

READY_S: Final = 3.0
PAUSE_S: Final = 0.8
"""Between two things that an operator does, on the average."""
RECOVERS: Final = 0.3
"""Share of steps that let go, clear what is latched, and arm: else most of a run is spent at rest."""
POWER_S: Final = 3.0
"""He waits up to so long for power that an emergency stop has taken."""
DRIVES: Final = 0.3
"""Share of steps that move one channel of the stick alone, ..."""
FIRST: Final = 0.6
"""... and so often it is the first one."""
SLOW_M: Final = 0.1
"""A robot that gets no further than this between two things that its operator does is slow: ..."""
KEEPS_ON: Final = 0.3
"""... so often he keeps its stick where it is, ..."""
KEEPS_S: Final = 12.0
"""... for up to so long."""
NAMED: Final = {"path_follower": path_followers, "mode": modes}
"""Keys of a step whose value is a name."""
TRIES: Final = 50
SLOPED: Final = 0.3
"""Share of random runs on a slope, where the plant has one, ..."""
STEEPEST_DEG: Final = 10.0
GRIP: Final = {"floor_friction": 0.9}
"""... of a floor that grips: on the thesis's own one robot and wheels slide, which no one holds."""
PUT_ON: Final = {"start_heading": (0.0, 180.0), "start_joint": (-14.0, 8.0)}
"""Initial pose of a robot with a joint on its wall, in degrees.

Any way up, and with the joint bent, beside the bend by the wall, up to where it is slowed down.
"""
FAR: Final = 3.0
"""A value of a key without a known range is drawn from this to both sides."""


class Draw:
    """Draws missions for one robot."""

    def __init__(
        self, robot: AnyRobot, bench_setup: BenchSetup, chance: Generator, natures: frozenset[FaultProfile]
    ) -> None:
        self._robot: Final = robot
        self._bench_setup: Final = bench_setup
        self._chance: Final = chance
        kinds = [
            [
                name
                for name, row in FAILING.items()
                if row.fault_profile is fault_profile and self._meets(name)
            ]
            for fault_profile in FaultProfile
            if fault_profile in natures
        ]
        self._kinds: Final = [names for names in kinds if names]
        self._sloped = False
        self._again: Callable[[float], dict[str, Any]] = lambda _: {}
        rows = inputs(bench_setup.step)
        self._held_by: Final = {key: row for key, row in rows.items() if isinstance(row, Holds)}
        self._main: Final = next(iter(self._held_by))
        self._full: Final = {channel.name: channel.full(robot) for channel in bench_setup.channels}
        self._slow: Final = self._full[self._held_by[self._main].channel] * PAUSE_S < SLOW_M

    @property
    def kinds(self) -> frozenset[str]:
        """The kinds of faults that it draws."""
        return frozenset(name for names in self._kinds for name in names)

    def mission(self, seconds: float) -> Mission:
        """Return the mission of a random run that begins with an armed robot."""
        floor = self._floor()
        self._sloped = "slope" in floor
        degraded = Degraded(self._robot, self._chance, sloped=self._sloped)
        self._again = degraded.again
        noise = Noise(
            stick=float(self._chance.choice([0.0, 0.02])),
            delay_ms=float(self._chance.choice([0.0, 80.0])),
            jitter_ms=float(self._chance.choice([0.0, 60.0])),
            loss=float(self._chance.choice([0.0, 0.1])),
        )
        goes = ({self._main: one} for one in map(self._held, repeat(self._held_by[self._main])) if one)
        steps = [self._step(at, does) for at, does in degraded.steps(self._lets_go(), goes)]
        steps += [*self._stands(), self._step(READY_S, {"arm": True}), *self.steps(READY_S + 0.5, seconds)]
        return Mission(
            title="a random run",
            duration_s=seconds,
            input=Input.STICK,
            noise=noise,
            plant=floor,
            step=tuple(sorted(steps, key=lambda step: step.at_s)),
            fault=(*degraded.faults, *self.faults(READY_S + 0.5, seconds - 2.0, degraded.faults)),
        )

    def steps(self, begin: float, end: float) -> tuple[Step, ...]:
        """Return what the operator does between two seconds, in order."""
        found, now = [], begin
        while (now := self._later(now, PAUSE_S)) < end - 0.1:
            if self._slow and self._chance.random() < KEEPS_ON:
                found.append(self._step(now, {**self._lets_go(), **self._goes()}))
                now += float(self._chance.uniform(0.0, KEEPS_S))
                continue
            habit = self._chance.random()
            if habit < RECOVERS:
                found.append(self._step(now, {**self._lets_go(), "clear": True, **self._again(now)}))
                if (now := self._later(now, 0.2)) < end - 0.1:
                    found.append(self._step(now, {"arm": True}))
                now += float(self._chance.uniform(0.0, POWER_S))
            elif habit < RECOVERS + DRIVES:
                found.append(self._step(now, self._drives()))
            else:
                found.append(self._step(now, self._does()))
        return tuple(found)

    def _drives(self) -> dict[str, Any]:
        others = list(self._held_by)[1:]
        if not others or self._chance.random() < FIRST:
            return {self._main: self._held(self._held_by[self._main])}
        key = others[int(self._chance.integers(len(others)))]
        value = self._held(self._held_by[key])
        return self._lets_go() if value is None else {key: value}

    def _goes(self) -> dict[str, Any]:
        """Return full stick, ahead or back."""
        row = self._held_by[self._main]
        share = float(self._chance.choice([-1.0, 1.0, 1.0]))
        return {self._main: share * self._full[row.channel] / row.into(1.0, self._robot)}

    def _later(self, now: float, pause_s: float) -> float:
        return round(now + float(self._chance.exponential(pause_s)) + 0.06, 3)

    def _lets_go(self) -> dict[str, Any]:
        keys = {row.channel: key for key, row in reversed(self._held_by.items())}
        return dict.fromkeys(keys.values(), 0.0)

    def _floor(self) -> dict[str, float]:
        """Return the plant's parameters on a slope or put on its wall; nothing for the flat."""
        known = _parameters(self._robot)
        if known >= PUT_ON.keys():
            degrees = {name: float(self._chance.uniform(*between)) for name, between in PUT_ON.items()}
            return {name: round(math.radians(angle), 4) for name, angle in degrees.items()}
        if "slope" not in known or self._chance.random() >= SLOPED:
            return {}
        slope = float(self._chance.uniform(-STEEPEST_DEG, STEEPEST_DEG))
        return {"slope": round(math.radians(slope), 4), **GRIP}

    def faults(self, begin: float, end: float, others: tuple[Fault, ...] = ()) -> tuple[Fault, ...]:
        """Return what fails between two seconds; of two things that cannot be together, the first."""
        found: list[Fault] = []
        for _ in range(int(self._chance.integers(0, 4)) if self._kinds else 0):
            name = str(self._chance.choice(self._natured()))
            fault = self._fault(name, round(float(self._chance.uniform(begin, end)), 3))
            if self._falls(fault) and not any(misfits([*others, *found, fault], self._robot)):
                found.append(fault)
        return tuple(found)

    def _natured(self) -> list[str]:
        """Return the kinds of one fault profile, each of which is as likely: else lies would be rare."""
        place = int(self._chance.integers(len(self._kinds))) if len(self._kinds) > 1 else 0
        return self._kinds[place]

    def _meets(self, name: str) -> bool:
        """Return True if this robot has the device of a kind of fault, without the run's random stream."""
        kind = kinds()[name].fault
        stated = {"kind": name, "at_s": 0.0, **FAILING[name].how(np.random.default_rng(0))}
        if "node" in kind.model_fields:
            stated["node"] = next(iter(kind.among.of(self._robot)), BRIDGE)
        return not any(key == "kind" for key, _ in read(stated).problems(self._robot))

    def _falls(self, fault: Fault) -> bool:
        """Return whether a fault may be on this floor."""
        return not (self._sloped and disables_power(fault))

    def _fault(self, name: str, second: float) -> Fault:
        row, kind = FAILING[name], kinds()[name]
        stated = {"kind": name, "at_s": second, **row.how(self._chance)}
        among = kind.fault.among.of(self._robot)
        if among and "node" in kind.fault.model_fields:
            stated["node"] = str(self._chance.choice(among))
        if "link" in kind.fault.model_fields and len(links := self._links(stated)) > 1:
            stated["link"] = str(self._chance.choice(links))
        # On a slope a bridge that receives an end request holds the robot: to start another one would kill
        # it.
        if kind.lasts and not (self._sloped and kind.fault is BridgeEnds):
            stated["for_s"] = round(float(self._chance.uniform(0.05, row.longest_s)), 3)
        return read(stated)

    def _links(self, stated: dict[str, Any]) -> list[str]:
        """Return the links on which this fault may be."""
        links = self._robot.links
        return [it for it in links if not any(read({**stated, "link": it}).problems(self._robot))]

    def _stands(self) -> Iterator[Step]:
        start_positions = self._bench_setup.start_positions
        zeros = {
            axis.role: start_positions.get(axis.role, 0.0)
            for axis in self._robot.axes
            if axis.needs_confirmation
        }
        if zeros:
            yield self._step(0.0, {"zero": zeros})

    def _does(self) -> dict[str, Any]:
        if self._chance.random() < 0.05:
            return {"silent_s": round(float(self._chance.uniform(0.1, 4.0)), 3)}
        if self._chance.random() < 0.03:
            return {"stray": str(self._chance.choice([it.value for it in Stray]))}
        does: dict[str, Any] = {}
        rows = [
            (key, row) for key, row in inputs(self._bench_setup.step).items() if not isinstance(row, Slope)
        ]
        held = set()
        for _ in range(int(self._chance.integers(1, 4))):
            key, row = rows[int(self._chance.integers(len(rows)))]
            channel = row.channel if isinstance(row, Holds) else key
            value = self._value(key, row)
            if value is not None and channel not in held:
                held.add(channel)
                does[key] = value
        return does or {"arm": True}

    def _value(self, key: str, row: object) -> Any:
        match row:
            case Holds():
                return self._held(row)
            case Presses():
                return str(self._chance.choice(list(row.buttons)))
            case Sends():
                return self._sent(key, row)
        return None

    def _held(self, row: Holds) -> float | None:
        full = self._full[row.channel]
        share = float(self._chance.choice([-1.0, 0.0, 0.0, 1.0, self._chance.uniform(-1.0, 1.0)]))
        one, two = (row.into(value, self._robot) for value in (1.0, 2.0))
        if math.isclose(two, 2.0 * one):
            return math.trunc(1e4 * share * full / one) / 1e4
        for _ in range(TRIES):
            value = round(float(self._chance.uniform(-FAR, FAR)), 4)
            if value and abs(row.into(value, self._robot)) <= full:
                return value
        return None

    def _sent(self, key: str, row: Sends) -> Any:
        if key == "force_disarm" and self._sloped:
            return None  # that robot rolls, as it was ordered to
        if key in {"terminate", "zero"}:
            return None  # the first ends the run; the second may be wrong, unnoticed
        stated = {
            get_args(one)[0] if get_origin(one) in {Annotated, Literal} else one
            for one in get_args(self._bench_setup.step.model_fields[key].annotation)
        }
        chance = self._chance
        drawn: dict[object, Callable[[], Any]] = {
            True: lambda: True,
            bool: lambda: bool(chance.integers(2)),
            str: lambda: str(chance.choice(NAMED[key](self._robot))),
        }
        for kind in stated & drawn.keys():
            return drawn[kind]()
        for _ in range(TRIES):
            value = round(float(self._chance.uniform(0.0, 1.0)), 4)
            if all(abs(param) <= 1.0 for param in row.params(value, self._robot)):
                return value
        return None

    def _step(self, second: float, does: dict[str, Any]) -> Step:
        return self._bench_setup.step.model_validate({"at_s": second, "title": f"at {second:g} s", **does})


def _parameters(robot: AnyRobot) -> set[str]:
    """Return the names of its plant's parameters."""
    return {row.name for row in find_plant(robot.plant.fmu).parameters}
