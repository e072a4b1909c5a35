"""A bench behind the live page's node, with a clock of the test's own; `page` is what one page receives."""

import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.control.desk import Desk
from emulators.control.live import Live
from emulators.live.bench import LiveBench
from emulators.paced import OutsideOperator, PacedRig
from emulators.rig import Rig
from emulators.run import RunOrder, operator_of
from firmware_bridge.live.messages import LIVE, OPENED
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds, from_seconds

PAGE, OTHER_PAGE = 1, 2


class ShownBench:
    """A mission of a robot on the live page."""

    def __init__(self, robot: str, mission: str, outside: OutsideOperator | None = None) -> None:
        machine = find(robot)
        setup = bench_setup_of(machine)
        script = mission_of(mission, machine, setup)
        order = RunOrder(machine, setup, mission, script, 0, Path(), operator=outside)
        operator = operator_of(order)
        rig = self.rig = Rig(script.on(machine), setup, operator, noise=script.noise)
        live = Live(machine, rig.devices, rig.world, rig.devices.plant, rig.faults, in_reach=True)
        paced = PacedRig(rig, from_seconds(script.duration_s), outside)
        desk = Desk(paced, live, self._report)
        self.node: Final = LiveBench(rig, paced, desk, order)
        self.now: Nanoseconds = 0
        self.sent: Final[list[Packet]] = []
        self._wake_at: Nanoseconds = 0
        self._count = 0

    def _report(self, text: str) -> None:
        self.node.report(text)

    def opens(self, page: int = PAGE) -> list[dict[str, Any]]:
        """Open a page; return what it receives at once."""
        return self.receives(OPENED, page)

    def receives(self, payload: bytes, page: int = PAGE) -> list[dict[str, Any]]:
        """Take a message of a page; return what leaves for it at once."""
        begun = len(self.sent)
        self._take(self.node.receive(Packet(LIVE, page, payload), self.now))
        return self.messages(page, begun)

    def runs(self, milliseconds: float, page: int = PAGE) -> list[dict[str, Any]]:
        """Let the clock run; return what a page has received."""
        begun, end = len(self.sent), self.now + round(milliseconds * MILLISECOND)
        while self._wake_at <= end:
            self.now = max(self.now, self._wake_at)
            self._wake_at = NEVER
            self._take(self.node.wake(self.now))
        self.now = end
        return self.messages(page, begun)

    def request(self, do: str, page: int = PAGE, **keys: Any) -> dict[str, Any]:
        """Send a request; return its answer."""
        self._count += 1
        found = self.receives(json.dumps({"id": self._count, "do": do, **keys}).encode(), page)
        (answer,) = (one for one in found if one.get("id") == self._count)
        return answer

    def does(self, do: str, **keys: Any) -> dict[str, Any]:
        """Do the same where it must not be refused."""
        answer = self.request(do, **keys)
        assert answer["ok"], answer
        return answer

    def state(self) -> dict[str, Any]:
        """Return the newest state that the page has received."""
        states = [one for one in self.messages(PAGE, 0) if one.get("kind") == "state"]
        return states[-1]

    def messages(self, page: int, begun: int) -> list[dict[str, Any]]:
        """Return a page's messages from a place on."""
        mine = (one for one in self.sent[begun:] if one.link == LIVE and one.address in {0, page})
        return [json.loads(one.payload, parse_constant=_refused) for one in mine]

    def _take(self, reaction: Reaction) -> None:
        self._wake_at = reaction.wake_at
        self.sent.extend(reaction.sent)


def _refused(text: str) -> Any:
    raise AssertionError(f"{text} is no JSON: a browser refuses the message")


@contextmanager
def shown(robot: str, mission: str, outside: OutsideOperator | None = None) -> Iterator[ShownBench]:
    """Start a bench; let go of its plant at the end."""
    bench = ShownBench(robot, mission, outside)
    try:
        yield bench
    finally:
        bench.rig.finish()
