"""Mistakes of a master that is the `canopen` library, against emulated drives: frames show the reason."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Final

import canopen
import pytest

from emulators.devices import devices
from emulators.epos2.drive import Epos2
from emulators.family import Devices
from emulators.wires import CanWire
from emulators.world import World
from firmware_bridge.explain.explainer import Explained, Setup, explain
from firmware_bridge.explain.source import frames
from firmware_bridge.node import CAN
from firmware_bridge.recording import EPOCH, candump_line
from firmware_bridge.robot_types import find
from hil_tests.interop.virtual_master import Master

RARS: Final = find("rars")
Script = Callable[["Session"], None]


class Session:
    """A script's calls, in the library's own terms."""

    def __init__(self, emulated: Devices) -> None:
        self.log: list[str] = []
        world, wire = World(emulated.physics), CanWire(RARS.links["drives"].rate)
        wire.observe(lambda now, _, packet: self.log.append(candump_line(now, packet, "can0", EPOCH)))
        for name, drive in emulated.nodes(Epos2).items():
            world.attach(name, drive, {CAN: wire})
        self.master = Master(world, wire, 1, canopen.ObjectDictionary())
        self.node: Any = self.master.node

    def write(self, index: int, value: int, size: int = 2) -> None:
        self.node.sdo.download(index, 0, value.to_bytes(size, "little", signed=value < 0))

    def polls(self, seconds: float = 2.0) -> None:
        """Read statusword, mode and position again and again, as a script that waits."""
        for _ in range(round(seconds / 0.1)):
            for index in (0x6041, 0x6061, 0x6064):
                self.node.sdo.upload(index, 0)
            self.master.bus.runs(0.1)

    def enables(self, last: int = 0x0F) -> None:
        for word in (0x06, 0x07, last):
            self.write(0x6040, word)
            self.master.bus.runs(0.05)
            self.node.sdo.upload(0x6041, 0)

    def sets_up(self, mode: int) -> None:
        self.node.nmt.state = "OPERATIONAL"
        self.write(0x6402, 1)
        self.write(0x6060, mode, 1)
        self.node.sdo.upload(0x6041, 0)


def good(session: Session) -> None:
    session.sets_up(3)
    session.enables()
    session.write(0x60FF, 300, 4)
    session.polls()


def at_once(session: Session) -> None:
    session.sets_up(3)
    session.write(0x60FF, 300, 4)
    session.write(0x6040, 0x0F)
    session.polls()


def set_point_before_power(session: Session) -> None:
    session.sets_up(1)
    session.write(0x607A, 100_000, 4)
    session.enables(0x1F)
    session.polls()


def without_set_point(session: Session) -> None:
    session.sets_up(1)
    session.enables()
    session.write(0x607A, 100_000, 4)
    session.polls()


def wrong_target(session: Session) -> None:
    session.sets_up(1)
    session.enables()
    session.write(0x60FF, 300, 4)
    session.polls()


def halted(session: Session) -> None:
    session.sets_up(3)
    session.enables(0x010F)
    session.write(0x60FF, 300, 4)
    session.polls()


def pre_operational(session: Session) -> None:
    session.write(0x6402, 1)
    session.write(0x6060, 3, 1)
    for word in (0x06, 0x07, 0x0F):
        session.master.network.send_message(0x201, word.to_bytes(2, "little"))
    for _ in range(20):
        session.master.network.send_message(0x501, bytes.fromhex("0F002C010000"))
        session.polls(0.1)


MISTAKES: Final[dict[str, tuple[Script, str]]] = {
    "at once": (at_once, "controlword 0x000F in switch on disabled has no transition: write 0x0006 first"),
    "set-point before power": (set_point_before_power, "was set before it was enabled"),
    "no new set-point": (without_set_point, "bit 4 of the controlword (new set-point) was not set after it"),
    "wrong target": (wrong_target, "0x60FF was written, but mode 1 takes its target from 0x607A"),
    "halt": (halted, "controlword bit 8 (halt) is set"),
    "pre-operational": (pre_operational, "its NMT state is pre-operational: PDOs are ignored"),
}


@pytest.fixture
def emulated() -> Iterator[Devices]:
    made = devices(RARS)
    yield made
    made.plant.close()


def played(emulated: Devices, script: Script, folder: Path) -> Explained:
    session = Session(emulated)
    script(session)
    session.master.network.bus = None
    path = folder / "can.log"
    path.write_text("".join(f"{line}\n" for line in session.log))
    return explain(frames(path, lambda _: None), Setup(device="epos2"))


@pytest.mark.parametrize("name", MISTAKES)
def test_the_reason_is_the_first_cause(name: str, emulated: Devices, tmp_path: Path) -> None:
    script, cause = MISTAKES[name]
    found = played(emulated, script, tmp_path)
    (one,) = found.incidents
    assert (one.kind.name, one.node) == ("not_moving", 1)
    assert cause in one.causes[0]


def test_a_session_in_good_order_has_no_incident(emulated: Devices, tmp_path: Path) -> None:
    assert played(emulated, good, tmp_path).incidents == ()
