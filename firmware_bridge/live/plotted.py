"""Values of a run for a plotter that receives JSON over UDP, as PlotJuggler's UDP server does.

A node around a node: it sends what is new at most 50 times a second, and changes nothing. The values are
those of the live page's state. Nothing waits for a receiver: a datagram that has none is lost.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, Final

from firmware_bridge.bridge import Bridge
from firmware_bridge.live.messages import encoded
from firmware_bridge.live.state import Json, bridge_state
from firmware_bridge.node import Finite, Node, Stoppable, holds
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot
from firmware_bridge.units import MILLISECOND, Nanoseconds, to_seconds

PLOTS: Final = "plotjuggler"
"""The link to the plotter; it has one other end."""
SENT_EVERY: Final[Nanoseconds] = 20 * MILLISECOND
TIME: Final = "timestamp"
"""Key of the run's instant in s, which PlotJuggler takes for the time where that is chosen."""
POSE: Final = ("x_m", "y_m", "heading_rad")
_ON_AXES: Final = ("position", "velocity", "target", "current_a", "temperature_c")
_ON_LINK: Final = ("age_s", "loss_percent")


def values_of(state: Json) -> Json:
    """Return the numbers of the live page's state, in groups, by their names; without those not known."""
    return known(
        {
            TIME: state["at_s"],
            "armed": float(bool(state.get("armed"))),
            "interlocks": float(len(state.get("interlocks", ()))),
            "drives": {axis["name"]: _of(axis, _ON_AXES) for axis in state.get("axes", ())},
            "pose": _pose(state.get("pose")),
            "true_pose": _pose(state.get("true_pose")),
            "command": state.get("command", {}),
            "measured": state.get("measured", {}),
            "margin": _of(state.get("margin") or {}, ("value", "least")),
            "operator": _of(state.get("operator", {}), _ON_LINK),
            "buses": {bus["name"]: _of(bus, ("load_percent",)) for bus in state.get("buses", ())},
        }
    )


def of_bridge(robot: AnyRobot, bridge: Bridge) -> Callable[[Nanoseconds], Json]:
    """Return what reads a bridge's values."""
    return lambda now: values_of({**bridge_state(robot, bridge), "at_s": to_seconds(now)})


class Plotted:
    """A node whose values are sent to a plotter."""

    def __init__(self, node: Node, values: Callable[[Nanoseconds], Json]) -> None:
        """Take the node as it is carried, and what returns its values, with `timestamp`, at an instant."""
        self._node: Final = node
        self._values: Final = values
        self._sent_at: Nanoseconds = -SENT_EVERY
        self._time: Any = None
        """`timestamp` of the last datagram: a bench that is paused sends nothing."""

    @property
    def holding(self) -> bool:
        """True while the node keeps the robot from moving after a command to end."""
        return holds(self._node)

    @property
    def finished(self) -> bool:
        """True once the node's own time is over."""
        return isinstance(self._node, Finite) and self._node.finished

    def receive(self, packet: Packet, now: Nanoseconds) -> Reaction:
        """Pass on a packet; what a plotter sends is taken for nothing."""
        if packet.link == PLOTS:
            return self._with_values(self._node.wake(now), now)
        return self._with_values(self._node.receive(packet, now), now)

    def wake(self, now: Nanoseconds) -> Reaction:
        """Wake the node."""
        return self._with_values(self._node.wake(now), now)

    def stop(self, now: Nanoseconds) -> Reaction:
        """Stop the node, where it can be stopped."""
        reaction = self._node.stop(now) if isinstance(self._node, Stoppable) else Reaction()
        return self._with_values(reaction, now)

    def _with_values(self, reaction: Reaction, now: Nanoseconds) -> Reaction:
        if now - self._sent_at < SENT_EVERY:
            return reaction
        self._sent_at = now
        values = self._values(now)
        if values[TIME] == self._time:
            return reaction
        self._time = values[TIME]
        return Reaction((*reaction.sent, Packet(PLOTS, 0, encoded(values))), reaction.wake_at)


def _of(table: Mapping[str, Any], names: Sequence[str]) -> Json:
    return {name: table.get(name) for name in names}


def _pose(pose: Sequence[float | None] | None) -> Json:
    return dict(zip(POSE, pose or (), strict=False))


def known(table: Mapping[str, Any]) -> Json:
    """Return what is a number, in the groups that have one."""
    found: Json = {}
    for name, value in table.items():
        if isinstance(value, Mapping):
            if group := known(value):
                found[name] = group
        # JSON has no NaN, and a value must end no run.
        elif isinstance(value, int | float) and math.isfinite(value):
            found[name] = value
    return found
