"""Devices without a robot behind their control desk: each kind of fault is answered, and they live on."""

import json
from collections.abc import Callable

import pytest

from emulators.arduino_omni.commands import ar2, board
from emulators.bench.faults.failures import failures_of
from emulators.cia402.commands import emulate as cia402
from emulators.cli.emulation import Emulation
from emulators.control.desk import CONTROL, Desk
from emulators.epos2.commands import emulate as epos2
from firmware_bridge.packet import Packet
from firmware_bridge.units import MILLISECOND

STARTS: dict[str, Callable[[], Emulation]] = {
    "epos2": lambda: epos2.start(epos2.DrivesOptions(node="1-2", serial="pty")),
    "cia402": lambda: cia402.start(cia402.ServoOptions(node="1-2")),
    "board": lambda: board.start(board.BoardOptions(firmware="mw")),
    "ar2": lambda: ar2.start(ar2.Ar2Options()),
}


@pytest.mark.parametrize("family", STARTS)
def test_each_fault_of_devices_alone_is_answered_and_they_live_on(family: str) -> None:
    emulation = STARTS[family]()
    assert emulation.live is not None
    live = emulation.live()
    desk = Desk(emulation.node, live, lambda _: None)
    desk.wake(0)
    now, begun = 400 * MILLISECOND, 0
    for failure in failures_of(live.robot):
        for request in (
            {"do": "inject", "fault": failure.kind, "keys": dict(failure.keys)},
            {"do": "clear"},
            {"do": "state"},
        ):
            now += MILLISECOND
            sent = desk.receive(Packet(CONTROL, 1, json.dumps(request).encode()), now).sent
            (answer,) = (json.loads(one.payload) for one in sent if one.link == CONTROL)
            assert "\n" not in answer.get("error", "")
            assert answer["ok"] or request["do"] == "inject"
            begun += answer["ok"] and request["do"] == "inject"
        assert answer["faults"] == []
    assert begun >= 5
