"""The states in which a failure meets a robot: the operator's command, and the resulting motion."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Final

from emulators.bench.bench_setup import Channel
from emulators.bench.step import Holds, inputs
from emulators.testing.rig import VirtualRig

SHARE: Final = 0.5
"""Share of full stick, on each channel that a state drives. Assumed: a usual command."""
GOES_S: Final = 1.5
"""Time by which a robot has reached the commanded speed; assumed of those that will come."""
STOPPING_S: Final = 0.1
STOPPED_S: Final = 2.0


@dataclass(frozen=True, slots=True)
class OperatingState:
    """One state, and how an armed robot at standstill is brought to it."""

    name: str
    enter: Callable[[VirtualRig], None]


def states_of(rig: VirtualRig) -> tuple[OperatingState, ...]:
    """Return the states of a robot: without power, at standstill, each motion, and its stops."""
    channels = rig.bench_setup.channels
    whole = [channel for channel in channels if not channel.stick_only]
    requests = {f"{channel.name} {SHARE:.0%}": _command(rig, [channel]) for channel in channels}
    if len(whole) > 1:
        requests[f"{', '.join(channel.name for channel in whole)} {SHARE:.0%}"] = _command(rig, whole)
    first = next(iter(requests.values()))
    return (
        OperatingState("disarmed", _disarmed),
        OperatingState("at rest", lambda rig: rig.runs(STOPPED_S)),
        *(OperatingState(name, _driving(command)) for name, command in requests.items()),
        OperatingState("stopping", _stopping(first)),
        OperatingState("emergency stop", _stopped(first)),
    )


def _command(rig: VirtualRig, channels: list[Channel]) -> Mapping[str, float]:
    """Return a step's values for its share of full stick on these channels."""
    return {key: value for channel in channels for key, value in _steps(rig, channel)}


def _steps(rig: VirtualRig, channel: Channel) -> Iterator[tuple[str, float]]:
    for key, row in inputs(rig.bench_setup.step).items():
        if isinstance(row, Holds) and row.channel == channel.name:
            # The first key is the channel's own, in its unit or in a multiple of it.
            yield key, SHARE * channel.full(rig.robot) / row.into(1.0, rig.robot)
            return


def _driving(command: Mapping[str, float]) -> Callable[[VirtualRig], None]:
    def enter(rig: VirtualRig) -> None:
        rig.operator.does("drives", **command)
        rig.runs(GOES_S)

    return enter


def _disarmed(rig: VirtualRig) -> None:
    rig.operator.disarms()
    rig.runs(STOPPED_S)


def _stopping(command: Mapping[str, float]) -> Callable[[VirtualRig], None]:
    def enter(rig: VirtualRig) -> None:
        _driving(command)(rig)
        rig.operator.returns_to_neutral()
        rig.runs(STOPPING_S)

    return enter


def _stopped(command: Mapping[str, float]) -> Callable[[VirtualRig], None]:
    def enter(rig: VirtualRig) -> None:
        _driving(command)(rig)
        rig.operator.stops()
        rig.operator.returns_to_neutral()
        rig.runs(STOPPED_S)

    return enter
