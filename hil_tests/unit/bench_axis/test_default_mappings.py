"""Every default receive PDO of a drive moves its shaft, in each mode that it can serve.

Source: EDS of the EPOS2: RPDO 1 carries the controlword, RPDO 2 controlword and mode of operation, RPDO 3
controlword and target position, RPDO 4 controlword and target velocity.
"""

from struct import pack
from typing import Final, NamedTuple

import pytest

from emulators.epos2.objects.device_profile import EPOS2_70_10
from emulators.servo import kernel
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.address import Address
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.modes import Mode
from firmware_bridge.units import MILLISECOND, SECOND
from hil_tests.rows import every
from hil_tests.unit.bench_axis.axis_on_bus import AxisOnBus
from hil_tests.unit.bench_axis.test_path_on_the_bus import POSITIONS, download
from hil_tests.unit.bench_axis.test_path_on_the_bus import frames as path_frames

ENABLING: Final = (0x06, 0x07, 0x0F)
START: Final = 0x1F
REACHED: Final = 1 << 10
ATTAINED: Final = 1 << 12


class Served(NamedTuple):
    """A mode, what is written before the drive is enabled, and what has to come of it."""

    mode: int
    before: tuple[tuple[Address, int], ...]
    shows: Address
    value: int
    within: int = 0


SERVED: Final = (
    Served(Mode.PROFILE_POSITION, ((od.TARGET_POSITION, 3000),), od.POSITION_ACTUAL, 3000, 2),
    Served(Mode.PROFILE_VELOCITY, ((od.TARGET_VELOCITY, 60),), od.VELOCITY_DEMAND, 60),
    Served(Mode.HOMING, ((od.HOMING_METHOD, 35), (at.HOME_POSITION, 777)), od.POSITION_ACTUAL, 777, 2),
    Served(Mode.POSITION, ((at.POSITION_MODE_SETTING, 40),), od.POSITION_ACTUAL, 40, 2),
    Served(Mode.VELOCITY, ((at.VELOCITY_MODE_SETTING, 60),), od.VELOCITY_DEMAND, 60),
    Served(Mode.CURRENT, ((at.CURRENT_MODE_SETTING, 30),), at.CURRENT_DEMAND, 30),
)


def write(address: Address, value: int) -> tuple[int, str]:
    """An expedited SDO download to node 1."""
    size = EPOS2_70_10.objects[address].type.size
    command = {1: 0x2F, 2: 0x2B, 4: 0x23}[size]
    raw = (value & (1 << 8 * size) - 1).to_bytes(size, "little").ljust(4, b"\0")
    return 0x601, (pack("<BHB", command, *address) + raw).hex()


def word(number: int, value: int, behind: bytes = b"") -> tuple[int, str]:
    return 0x101 + 0x100 * number, (pack("<H", value) + behind).hex()


def moved(monkeypatch: pytest.MonkeyPatch, frames: list[tuple[int, str]], shows: Address) -> int:
    """Send the frames, and return what the object shows 2.5 s later."""
    run = AxisOnBus(monkeypatch, kernel.NATIVE, [(0x000, "0101"), *frames])
    run.world.run(100 * MILLISECOND + 5 * SECOND // 2)
    return run.store.live(shows)


@every("served", SERVED, ids=lambda served: Mode(served.mode).name.lower())
@every("number", (1, 2))
def test_controlword_and_mode_serve_every_mode(
    monkeypatch: pytest.MonkeyPatch, served: Served, number: int
) -> None:
    """The mode behind each controlword of RPDO 2 is the one that is set already: it changes nothing."""
    behind = pack("<b", served.mode) if number == 2 else b""
    frames = [write(*each) for each in ((od.MODE, served.mode), *served.before)]
    frames += [word(number, value, behind) for value in (*ENABLING, START)]
    assert abs(moved(monkeypatch, frames, served.shows) - served.value) <= served.within


@every("repeats", (1, 5))
def test_controlword_and_target_serve_their_modes(monkeypatch: pytest.MonkeyPatch, repeats: int) -> None:
    """Repeat the last one as a master may: in a PDO the edge counts."""
    target, velocity = pack("<i", 2500), pack("<i", -45)
    frames = [write(od.MODE, Mode.PROFILE_POSITION)]
    frames += [word(3, value, target) for value in (*ENABLING, *[START] * repeats)]
    assert abs(moved(monkeypatch, frames, od.POSITION_ACTUAL) - 2500) <= 2
    frames = [write(od.MODE, Mode.PROFILE_VELOCITY)]
    frames += [word(4, value, velocity) for value in (*ENABLING, *[ENABLING[-1]] * repeats)]
    assert moved(monkeypatch, frames, od.VELOCITY_DEMAND) == -45


@every("number", (1, 2))
def test_controlword_and_mode_run_a_path(monkeypatch: pytest.MonkeyPatch, number: int) -> None:
    frames = [*path_frames()[:-1], word(number, START, b"\x07" if number == 2 else b"")]
    assert moved(monkeypatch, frames[1:], od.POSITION_DEMAND) == POSITIONS[-1]


def test_a_new_mode_behind_the_controlword_drops_a_set_point_of_the_one_before(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    frames = [write(od.MODE, Mode.PROFILE_POSITION), write(od.TARGET_POSITION, 3000)]
    frames += [word(1, value) for value in ENABLING]
    frames += [word(2, START, pack("<b", Mode.HOMING))]
    assert abs(moved(monkeypatch, frames, od.POSITION_ACTUAL)) <= 2


@pytest.mark.parametrize("paths", [2, 3])
def test_a_written_controlword_starts_each_path_though_bit_4_stays_up(
    monkeypatch: pytest.MonkeyPatch, paths: int
) -> None:
    """maxon's command library never lowers it (recorded)."""
    begin = [write(od.MODE, Mode.INTERPOLATED_POSITION), *(write(od.CONTROLWORD, each) for each in ENABLING)]
    begin += [write(Address(0x60C4, 6), 1)]
    frames, last = begin, 0
    for _ in range(paths):
        records = [(last, 0, 100), (last + 400, 0, 0)]
        for position, velocity, ms in records:
            raw = pack("<i", position) + velocity.to_bytes(3, "little") + bytes([ms])
            frames += [(0x601, text) for text in download(raw)]
        frames += [write(od.CONTROLWORD, START)] * 4 + [(0x080, "")] * 20  # while one runs it starts no other
        last += 400
    assert moved(monkeypatch, frames, od.POSITION_DEMAND) == last
