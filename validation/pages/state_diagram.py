"""The power machine drawn from its table: a diagram in Mermaid's words, and the table itself."""

from typing import Final

from emulators.canopen.power_states import Happening, PowerStageEffect, RampOption, Transition
from emulators.epos2.control.power_states import TRANSITIONS
from firmware_bridge.canopen.cia402 import ControlwordCommand, PowerState
from firmware_bridge.families.epos2.wire.power_states import STATUSWORDS

HEADINGS: Final = ("no.", "from", "on", "to", "power stage", "slow-down requested by")
_FAULT: Final = 13


def title(state: PowerState) -> str:
    """Return a state's name for people."""
    return state.name.replace("_", " ").capitalize()


def trigger(row: Transition) -> str:
    """Return what moves the machine, for people."""
    if isinstance(row.trigger, Happening):
        return row.trigger.value
    name = {ControlwordCommand.DISABLE_OPERATION: "switch on, or disable operation"}.get(row.trigger)
    return name or row.trigger.name.replace("_", " ").lower()


def cells(row: Transition) -> tuple[str, ...]:
    """Return the texts of one line, as `HEADINGS` names them."""
    goes_on = ", then once more from there" if row.goes_on else ""
    ramp = "" if row.ramp is RampOption.NONE else f"{row.ramp.value} = 1"
    stage = "" if row.stage is PowerStageEffect.KEEP else row.stage.value
    return (str(row.number), title(row.source), trigger(row), title(row.target) + goes_on, stage, ramp)


def diagram() -> str:
    """Return the machine as a Mermaid state diagram.

    Transition 13 leads from every state before Operation enabled to one; it is drawn once, from their group.
    """
    before = {row.source: None for row in TRANSITIONS if row.number == _FAULT}
    lines = ["stateDiagram-v2", "    direction TB"]
    for state, word in STATUSWORDS.items():
        lines.append(f'    state "{title(state)}<br/>0x{word:04X}" as {state.name}')
    lines += ["    [*] --> START : 19 node reset", "    state not_enabled {"]
    lines += [f"        {state.name}" for state in before]
    lines += ["    }", f"    not_enabled --> {PowerState.FAULT_REACTION_DISABLED.name} : {_FAULT} fault"]
    merged: dict[tuple[PowerState, PowerState], list[str]] = {}
    for row in TRANSITIONS:
        if row.number != _FAULT:
            merged.setdefault((row.source, row.target), []).append(f"{row.number} {trigger(row)}")
    lines += [
        f"    {source.name} --> {target.name} : {' / '.join(labels)}"
        for (source, target), labels in merged.items()
    ]
    return "\n".join(lines)
