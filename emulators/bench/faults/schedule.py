"""Schedule that puts faults on a bench and takes them off, at their instants, and keeps a record."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from emulators.bench.faults.fault import Fault, Problem
from emulators.bench.faults.reading import misfits
from emulators.bench.faults.site import Site
from emulators.bench.records import FaultRecord
from firmware_bridge.units import NEVER, Nanoseconds, to_seconds

FAULT_STREAM: Final = 2
"""The first number beside the run's seed; the second is the fault's own, counted from 0 on this bench."""


class FaultError(Exception):
    """Faults that this bench cannot meet: every key, and what is wrong with it."""

    def __init__(self, problems: Sequence[Problem]) -> None:
        super().__init__(*problems)
        self.problems = tuple(problems)

    def __str__(self) -> str:
        """Return the problems, a line for each."""
        return "\n".join(f"{key}: {problem}" for key, problem in self.problems)


class Faults:
    """The faults of one bench; `records` lists those that were on, with their times."""

    def __init__(self, site: Site, seed: int = 0) -> None:
        self.records: Final[list[FaultRecord]] = []
        self._site: Final = site
        self._seed: Final = seed
        self._planned: dict[int, Fault] = {}
        """Those that have not ended, by their numbers."""
        self._count = 0
        self._record_of: dict[int, int] = {}

    def plan(self, faults: Sequence[Fault]) -> int:
        """Plan these faults, beside those that were planned before; return the number of the first.

        FaultError for any that cannot happen.
        """
        now, before = self._site.world.now, len(self._planned)
        everything = [*self._planned.values(), *faults]
        # In the messages faults count from the first one of this call, as in its mission file.
        problems = [
            (key.replace(f"fault[{number}]", f"fault[{number - before}]", 1), problem)
            for key, problem in misfits(everything, self._site.robot)
            for number in [int(key[key.index("[") + 1 : key.index("]")])]
        ]
        problems += [
            (f"fault[{index}].at_s", f"{fault.at_s:g} s is over: it is {to_seconds(now):g} s")
            for index, fault in enumerate(faults)
            if fault.begin < now
        ]
        if problems:
            raise FaultError(problems)
        first = self._count
        self._count += len(faults)
        self._planned.update(enumerate(faults, start=first))
        world = self._site.world
        # Ends before beginnings: at one instant the second fault meets a bench that the first has left.
        for number, fault in enumerate(faults, start=first):
            if fault.begin < fault.end < NEVER:
                world.call_at(fault.end, self._end, number)
        for number, fault in enumerate(faults, start=first):
            world.call_at(fault.begin, self._begin, number)
        return first

    def record_of(self, number: int) -> FaultRecord:
        """Return the record of a fault that is on; KeyError."""
        return self.records[self._record_of[number]]

    @property
    def standing(self) -> tuple[int, ...]:
        """The numbers of those that are on and have an end, the oldest first."""
        return tuple(self._record_of)

    def forget(self, number: int) -> None:
        """Take no more notice of a fault that could not begin."""
        self._planned.pop(number, None)
        at = self._record_of.pop(number, None)
        if at is not None:
            del self.records[at]

    def clear(self, number: int) -> None:
        """End a fault that is on before its time."""
        self._site.clear(self._planned[number])
        self._end(number)

    def end_soon(self, number: int) -> None:
        """End one within this instant, behind what begins in it; from within the world's own calls."""
        self._site.world.call_at(self.now, self._clear_or_forget, number)

    @property
    def now(self) -> Nanoseconds:
        """The present instant."""
        return self._site.world.now

    def _clear_or_forget(self, number: int) -> None:
        if number in self._record_of:
            self.clear(number)
        else:
            self._planned.pop(number, None)

    def _begin(self, number: int) -> None:
        fault, world = self._planned[number], self._site.world
        lasts = fault.end > fault.begin
        if lasts:
            self._record_of[number] = len(self.records)
        targets = tuple(sorted(fault.targets(self._site.robot)))
        ended = None if lasts else world.now
        self.records.append(FaultRecord(fault.kind, fault.title, targets, world.now, ended))
        # A generator for each: another fault that is planned behind it changes none of its draws.
        fault.put_on(self._site, np.random.default_rng([self._seed, FAULT_STREAM, number]))
        if not lasts:
            del self._planned[number]

    def _end(self, number: int) -> None:
        fault = self._planned.pop(number, None)
        if fault is None:
            return  # it was cleared before
        at = self._record_of.pop(number)
        record = self.records[at]
        fault.take_off(self._site)
        self.records[at] = FaultRecord(
            record.kind, record.title, record.nodes, record.began, self._site.world.now
        )
