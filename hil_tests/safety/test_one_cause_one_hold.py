"""A silent operator link is reported as a timeout, and not as a command that has become stale."""

from typing import Any, Final

import pytest

from firmware_bridge.intent import AgeLimit
from firmware_bridge.robot_types import find
from firmware_bridge.units import MILLISECOND, Nanoseconds
from hil_tests.safety.gate_bench import gate_of, names, well
from hil_tests.safety.stop_cases import START

RARS: Final = find("rars")
SILENT: Final[Nanoseconds] = RARS.operator.silent_ms * MILLISECOND
UNWELL: Final[dict[str, dict[str, Any]]] = {
    "command stale": {"sent_at": START - 600 * MILLISECOND - SILENT, "timestamped": True},
    "command not timestamped": {"age_limit": AgeLimit(needed=True)},
}


@pytest.mark.parametrize("row", UNWELL)
@pytest.mark.parametrize(("silence", "silent"), [(SILENT - 1, False), (SILENT, True)])
def test_at_the_silence_that_stops_the_other_row_gives_way(
    row: str, silence: Nanoseconds, *, silent: bool
) -> None:
    seen = well(RARS, START, intent={"received_at": START - silence}, **UNWELL[row])
    held = names(gate_of(RARS).rule(seen))
    assert (row in held, "operator link timeout" in held) == (not silent, silent)
