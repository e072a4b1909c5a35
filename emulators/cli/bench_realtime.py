"""`bench --realtime`: the same world at the clock's pace, with a control port, and stations from outside."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Final, Protocol

from firmware_bridge.cli.console import refusal, say
from firmware_bridge.units import NEVER, Nanoseconds

if TYPE_CHECKING:
    from emulators.rig import Rig
    from emulators.run import Carry, RunOrder
    from firmware_bridge.runtime.ports import Port

HOUR_S: Final = 3600.0
STATIONS: Final = """title = "Driven by stations"
duration_s = {duration}
[[step]]
at_s = 0.0
title = "stations drive"
arm = false
"""
"""A mission whose operator is outside; its step is not sent."""


class RealTimeOptions(Protocol):
    """The options of `bench` that need a clock."""

    @property
    def realtime(self) -> bool:
        """True at the clock's pace."""

    @property
    def control(self) -> str | None:
        """The control port's place."""

    @property
    def mavlink(self) -> str | None:
        """The stations' link in place of the mission's operator."""

    @property
    def live(self) -> bool:
        """True with a page for a browser."""

    @property
    def plotjuggler(self) -> str | None:
        """Place of a plotter."""

    @property
    def duration(self) -> float | None:
        """Time in s after which a run with stations ends."""


def check(given: RealTimeOptions) -> None:
    """End the program where an option needs another one, or others could drive the robot."""
    from firmware_bridge.cli.trusted import trust_of

    stray = [name for name in ("control", "mavlink", "live", "plotjuggler") if getattr(given, name)]
    if not given.realtime and stray:
        raise refusal(f"--{stray[0]} needs --realtime: virtual time waits for no one")
    if given.duration is not None and given.mavlink is None:
        raise refusal("--duration needs --mavlink: a mission states its own duration")
    if given.mavlink is not None:
        trust_of(given.mavlink, None, None, openly=False)


def stations_mission(duration_s: float | None) -> str:
    """Return the mission of a robot that stations drive, as a file's text."""
    return STATIONS.format(duration=HOUR_S if duration_s is None else duration_s)


def in_real_time(given: RealTimeOptions, order: "RunOrder", title: str) -> "Carry":
    """Return what carries a rig at the clock's pace; an error ends the program with a message."""

    def carry_rig(rig: "Rig", end: Nanoseconds, progress: Callable[[Nanoseconds], None]) -> None:
        from emulators.cli.emulation import NONE, UNIX, control_port
        from emulators.control.desk import CONTROL, Desk
        from emulators.control.live import Live
        from emulators.live.plot_values import of_rig
        from emulators.paced import OutsideOperator, PacedRig
        from firmware_bridge.cli.live_page import page_port
        from firmware_bridge.cli.plot_option import plotted
        from firmware_bridge.cli.real_time import carry
        from firmware_bridge.node import OPERATOR, Node
        from firmware_bridge.runtime.clock import LivedClock
        from firmware_bridge.runtime.ports import UdpPort

        operator = order.operator if isinstance(order.operator, OutsideOperator) else None
        link, place, clock = given.mavlink, given.control or UNIX, LivedClock()
        reports: list[Callable[[str], None]] = [say]
        live = Live(order.robot, rig.devices, rig.world, rig.devices.plant, rig.faults, in_reach=True)
        paced = PacedRig(rig, end, operator, progress)

        def report(text: str) -> None:
            for one in reports:
                one(text)

        desk = Desk(paced, live, report, clock)
        node: Node = desk
        openers: dict[str, Callable[[], Port]] = {}
        if link is not None:
            openers[OPERATOR] = lambda: UdpPort(link)
        if place != NONE:
            openers[CONTROL] = lambda: control_port(place, order.robot.name)
        if given.live:
            from emulators.live.bench import LiveBench
            from firmware_bridge.live.messages import LIVE

            node = page = LiveBench(rig, paced, desk, order)
            reports.append(page.report)
            openers[LIVE] = page_port
        node = plotted(node, given.plotjuggler, openers, of_rig(rig))
        stations = "" if link is None else f", operator on {link}"
        carry(node, openers, NEVER, f"{title} in real time{stations}", clock=clock)

    return carry_rig
