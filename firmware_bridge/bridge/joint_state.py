"""What state the bridge is in: its life, the motion permission, and what both allow; one table each.

The bridge's **life** goes one way: it starts (the devices are found, set up and given power), runs, stops
(the robot ramps to standstill), leaves (power off, the drives' watch over the bridge ends) and is finished. A
start that fails ends in *failed*: the drives are without power, and the reason is reported until the end.

The **motion permission** is one of seven states, and no other combination exists:

* *disarmed*: the drives hold still with power, and nothing moves on command. So it begins, and to here every
  loss of the permission leads.
* *armed*: motion commands count, as far as the interlocks permit. Only a request arms; no event does.
* *stopped*: an emergency stop is latched. Each axis brakes, then loses its power. Its reset leads to
  *disarmed*, at standstill alone, and starts nothing (ISO 13850).
* *terminated*: an emergency stop that only a restart of the bridge ends.
* *powered off*: the power was ordered off by force. It stays off until arming enables the drives again.
* *stopped, powered off* and *terminated, powered off*: both. Neither ends the other.

The power itself follows: it is the devices' own report that counts (`firmware_bridge.drivers.life_cycle`,
`firmware_bridge.bridge.power_down`). What is forbidden is in `FORBIDDEN`, and holds at every instant.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from types import MappingProxyType
from typing import Final


class Life(Enum):
    """Phase of the bridge's life."""

    STARTING = "starting"
    RUNNING = "running"
    FAILED = "failed"
    """Start-up failed: the drives are without power, the operator is informed of the reason."""
    STOPPING = "stopping"
    """The robot ramps to standstill."""
    LEAVING = "leaving"
    """Power goes off, and then the drives' watch over the bridge ends."""
    FINISHED = "finished"


class Motion(Enum):
    """State of the motion permission."""

    DISARMED = "disarmed"
    ARMED = "armed"
    STOPPED = "stopped"
    TERMINATED = "terminated"
    POWERED_OFF = "powered off"
    STOPPED_OFF = "stopped, powered off"
    TERMINATED_OFF = "terminated, powered off"


class Event(Enum):
    """What changes the motion permission."""

    ARM = "arm"
    """Granted: every need of the request is fulfilled."""
    ENABLE = "drives enabled for arming"
    DISARM = "disarm"
    """By the operator, an interlock that disarms, a lost station, or the end of the bridge."""
    POWER_OFF = "forced disarm"
    STOP = "emergency stop"
    """By anyone, or by an interlock that latches."""
    TERMINATE = "emergency stop until the restart"
    RESET = "reset of the emergency stop"


_M, _E = Motion, Event
SUCCESSORS: Final[Mapping[Motion, Mapping[Event, Motion]]] = MappingProxyType(
    {
        _M.DISARMED: {
            _E.ARM: _M.ARMED,
            _E.POWER_OFF: _M.POWERED_OFF,
            _E.STOP: _M.STOPPED,
            _E.TERMINATE: _M.TERMINATED,
        },
        _M.ARMED: {
            _E.DISARM: _M.DISARMED,
            _E.POWER_OFF: _M.POWERED_OFF,
            _E.STOP: _M.STOPPED,
            _E.TERMINATE: _M.TERMINATED,
        },
        _M.STOPPED: {
            _E.POWER_OFF: _M.STOPPED_OFF,
            _E.TERMINATE: _M.TERMINATED,
            _E.RESET: _M.DISARMED,
        },
        _M.TERMINATED: {_E.POWER_OFF: _M.TERMINATED_OFF},
        _M.POWERED_OFF: {
            _E.ENABLE: _M.DISARMED,
            _E.STOP: _M.STOPPED_OFF,
            _E.TERMINATE: _M.TERMINATED_OFF,
        },
        _M.STOPPED_OFF: {_E.TERMINATE: _M.TERMINATED_OFF, _E.RESET: _M.POWERED_OFF},
        _M.TERMINATED_OFF: {},
    }
)
"""Each state's successor by event; an event without a row leaves the state as it is."""
STOPS: Final = frozenset({_M.STOPPED, _M.TERMINATED, _M.STOPPED_OFF, _M.TERMINATED_OFF})
"""An emergency stop is latched."""
FOR_GOOD: Final = frozenset({_M.TERMINATED, _M.TERMINATED_OFF})
"""... that no request resets."""
OFF: Final = frozenset({_M.POWERED_OFF, _M.STOPPED_OFF, _M.TERMINATED_OFF})
"""The power was ordered off."""
NO_POWER: Final = STOPS | OFF
"""No drive may be given power."""


def successor(motion: Motion, event: Event) -> Motion:
    """Return the state after an event."""
    return SUCCESSORS[motion].get(event, motion)


@dataclass(frozen=True, slots=True)
class Forbidden:
    """Joint states that must not exist: of these lives with these permissions."""

    lives: frozenset[Life]
    motions: frozenset[Motion]
    why: str


FORBIDDEN: Final = (
    Forbidden(
        frozenset(Life) - {Life.RUNNING},
        frozenset({Motion.ARMED}),
        "only a bridge that runs has interlocks that judge a motion",
    ),
)
"""The joint states that no event leads to."""


def forbidden(life: Life, motion: Motion) -> str | None:
    """Return why this joint state must not exist; None where it may."""
    return next((row.why for row in FORBIDDEN if life in row.lives and motion in row.motions), None)
