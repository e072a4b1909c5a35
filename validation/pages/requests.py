"""The page of requests: who may make each, what it needs and does; states of the motion permission."""

from collections.abc import Callable, Iterable, Sequence
from inspect import cleandoc
from typing import Final, TypeAlias

from firmware_bridge.bridge import joint_state
from firmware_bridge.bridge.joint_state import FORBIDDEN, SUCCESSORS, Event, Life, Motion
from firmware_bridge.bridge.orders import ALWAYS, ORDERS, Order
from firmware_bridge.intent import OF_ANYONE

Table: TypeAlias = Callable[[Sequence[str], Iterable[Sequence[str]]], str]
TITLE: Final = "Requests: who may make them, and what they need"
TEXT: Final = """A request is refused by the first need that only someone's action fulfils
(MAV_RESULT_DENIED), else by the first that time may fulfil (MAV_RESULT_TEMPORARILY_REJECTED), marked *waits*
below. Needs are looked at in this order. An emergency stop and a forced disarm need nothing, and are obeyed
in every phase of the bridge. Of a station that is not in control they are an emergency stop; all else of it
is refused ([one station in control](decisions/station-in-control.md)). A motion is no request: [interlocks
and limits](safety.md) judge it in every cycle."""


def _needs(order: Order) -> str:
    return "; ".join(f"{need.text}{' (*waits*)' if need.temporary else ''}" for need in order.needs) or "-"


def _who(key: object) -> str:
    return "any station" if key in OF_ANYONE else "station in control"


def _when(order: Order) -> str:
    return "always" if order.lives == ALWAYS else ", ".join(one.value for one in Life if one in order.lives)


def diagram() -> str:
    """Return the states of the motion permission in Mermaid."""
    lines = ["stateDiagram-v2", "    direction LR"]
    lines += [f'    state "{motion.value}" as {motion.name}' for motion in Motion]
    lines.append(f"    [*] --> {Motion.DISARMED.name}")
    lines += [
        f"    {motion.name} --> {after.name} : {event.value}"
        for motion, row in SUCCESSORS.items()
        for event, after in row.items()
    ]
    return "\n".join(lines)


def parts(table: Table) -> tuple[str, ...]:
    """Return the page's parts; `table` makes a table of headings and rows."""
    prose = cleandoc(joint_state.__doc__ or "").partition("\n\n")[2]
    return (
        TEXT,
        table(
            ("request", "by", "while the bridge is", "needs", "does"),
            (
                (order.title, _who(key), _when(order), _needs(order), order.does)
                for key, order in ORDERS.items()
            ),
        ),
        "## States",
        prose,
        f"```mermaid\n{diagram()}\n```",
        table(
            ("state", *(event.value for event in Event)),
            (
                (motion.value, *(row[event].value if event in row else "" for event in Event))
                for motion, row in SUCCESSORS.items()
            ),
        ),
        "An empty cell leaves the state as it is. No event leads to these joint states:",
        table(
            ("bridge", "motion permission", "why"),
            (
                (
                    ", ".join(one.value for one in Life if one in row.lives),
                    ", ".join(one.value for one in Motion if one in row.motions),
                    row.why,
                )
                for row in FORBIDDEN
            ),
        ),
    )
