"""Cost of the live page on a bench at the clock's pace: what an open page adds to the serving process.

Each part is timed alone, and counted as often as it comes in a second: the state, the frames in words and the
messages 20 times, with their way into a socket; a moment to go back to once; each frame of the bus once, for
the incidents.
"""

import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path
from typing import Final

from websockets.sync.client import connect

from benchmarks.figure import Figure
from emulators.bench.bench_setup import bench_setup_of
from emulators.bench.mission import find as mission_of
from emulators.control.desk import Desk
from emulators.control.live import Live
from emulators.live.bench import LiveBench
from emulators.paced import PacedRig
from emulators.rig import Rig
from emulators.run import RunOrder, operator_of
from firmware_bridge.explain.explainer import BusExplainer, Setup
from firmware_bridge.live.messages import ALL_PAGES, SHOWN_EVERY, encoded
from firmware_bridge.live.socket import LiveSocket
from firmware_bridge.packet import Packet
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, SECOND, from_seconds

ROBOTS: Final = (("rars", "circles"), ("rome", "line"), ("climber", "square"))
WARM_S: Final = 8
TIMES: Final = 300
REPEATS: Final = 5
GOAL_PERCENT: Final = 2.0
A_SECOND: Final = SECOND // SHOWN_EVERY


def seconds(work: Callable[[], object], times: int = TIMES) -> float:
    """Return the processor time of one call: the least of some measurements."""
    found = []
    for _ in range(REPEATS):
        begun = time.process_time()
        for _ in range(times):
            work()
        found.append((time.process_time() - begun) / times)
    return min(found)


def cost(robot: str, mission: str) -> list[float]:
    """Return the share of a core in percent: messages, sending, moments, incidents."""
    machine = find(robot)
    setup = bench_setup_of(machine)
    script = mission_of(mission, machine, setup)
    order = RunOrder(machine, setup, mission, script, 0, Path())
    rig = Rig(script.on(machine), setup, operator_of(order), noise=script.noise)
    live = Live(machine, rig.devices, rig.world, rig.devices.plant, rig.faults, in_reach=True)
    paced = PacedRig(rig, from_seconds(script.duration_s))
    page = LiveBench(rig, paced, Desk(paced, live, lambda _: None), order)
    frames: list[tuple[int, Packet]] = []
    for wire in rig.can_wires.values():
        wire.observe(lambda now, _, packet: frames.append((now, packet)))
    for step in range(WARM_S * 100):
        page.wake(step * 10 * MILLISECOND)
    state = page._state(0)  # noqa: SLF001 - what a page receives
    messages = seconds(lambda: encoded(page._state(0))) + seconds(lambda: list(page._news(0)))  # noqa: SLF001
    moments = seconds(rig.snapshot, 5)
    incidents = _incidents(frames)
    sending = _sending(encoded(state))
    rig.finish()
    return [
        100.0 * one
        for one in (A_SECOND * messages, A_SECOND * sending, moments, incidents * len(frames) / WARM_S)
    ]


def _incidents(frames: list[tuple[int, Packet]]) -> float:
    """Return the time for one frame."""
    if not frames:
        return 0.0

    def explain() -> None:
        bus = BusExplainer(Setup())
        for now, packet in frames:
            bus.take(now, packet.address, packet.payload)

    return seconds(explain, 1) / len(frames)


def _sending(message: bytes) -> float:
    """Return the time of one message's way into a socket, and out of it at the page."""
    port = LiveSocket()
    number = port.name.rpartition(":")[2].partition("/")[0]
    # The port has no thread of its own, and the client waits for its answer.
    with ThreadPoolExecutor(1) as pool, ExitStack() as stack:
        address = f"ws://127.0.0.1:{number}/{port.token}/ws"
        opening = pool.submit(lambda: stack.enter_context(connect(address)))
        while not opening.done():
            port.read(0)
        page = opening.result()

        def send() -> None:
            port.write(ALL_PAGES, message, 0)
            page.recv()

        found = seconds(send)
        # What closes the page needs no answer then.
        port.close()
    return found


def figures() -> Iterator[Figure]:
    """Measure the page of each robot."""
    for robot, mission in ROBOTS:
        yield Figure(
            name=f"live page, {robot}, {mission}",
            value=sum(cost(robot, mission)),
            unit="%",
            against="a core",
            reference=100.0,
            goal=GOAL_PERCENT / 100.0,
        )
