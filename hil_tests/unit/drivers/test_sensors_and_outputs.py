"""Sensors and outputs at the pins of emulated drives, over CAN and over a serial line."""

from collections.abc import Callable, Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_bridge.canopen import cia301
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.canopen.cia301 import NmtCommand
from firmware_bridge.canopen.data_type import DataType
from firmware_bridge.canopen.sdo_client import Outcome, SdoRefusedError, SdoTimeoutError, Transfer
from firmware_bridge.canopen_drive.driver.object_request import ObjectRequest
from firmware_bridge.canopen_drive.driver.object_sensor import MeasuredObject, ObjectSensor
from firmware_bridge.drivers.driver import Level, Power, Reading
from firmware_bridge.drivers.life_cycle import DriverState
from firmware_bridge.families.epos2.driver.inputs_outputs import DigitalOutputs
from firmware_bridge.families.epos2.driver.serial.link_drivers import over_serial
from firmware_bridge.families.epos2.wire import address as at
from firmware_bridge.families.epos2.wire.functions import OUTPUT_STATE
from firmware_bridge.node import CAN
from firmware_bridge.packet import Packet, Reaction
from firmware_bridge.robot import AnyRobot, RobotFileError
from firmware_bridge.units import MILLISECOND, NEVER, Nanoseconds
from hil_tests.unit.drivers.link_drivers_bench import HOST, Bench
from hil_tests.unit.drivers.robots import LINK, changed

VOLTAGE = MeasuredObject(at.ANALOGUE_INPUT_1, DataType.INTEGER16, 6.0, 1000.0)
ON, OFF = Level(on=True), Level(on=False)


def equipped(table: dict[str, Any]) -> None:
    """Two wheels; a lamp and a magnet at one, a horn at the other, a second sensor beside the battery."""
    table["axes"] = table["axes"][:2]
    table["outputs"] = [
        {"name": name, "title": name, "link": LINK, "settings": {"axis": axis, "output": pin}}
        for name, axis, pin in (("lamp", "left", 1), ("magnet", "left", 3), ("horn", "right", 2))
    ]
    del table["guard"]
    reach = {"name": "reach", "title": "reach", "link": LINK, "every_ms": 100, "silent_ms": 300}
    table["sensors"].append(reach | {"settings": {"axis": "left", "input": 2, "per_volt": 0.5}})


def on_can() -> AnyRobot:
    return changed(equipped)


def on_line() -> AnyRobot:
    return over_serial(changed(equipped))


@pytest.fixture(params=[on_can, on_line])
def bench(request: pytest.FixtureRequest) -> Iterator[Bench]:
    """Yield a robot that runs; the guard must have nothing against its frames."""
    make: Callable[[], AnyRobot] = request.param
    made = Bench(make())
    made.axes["left"].analogue_1_mv = 4_000
    made.axes["left"].analogue_2_mv = -1_500
    made.starts()
    yield made
    assert made.guard.refusals == ()


def pins(bench: Bench, axis: str) -> int:
    return bench.axes[axis].outputs & 0b1111


def test_a_sensor_reports_its_volts_in_its_own_unit(bench: Bench) -> None:
    bench.runs(0.3)
    readings = bench.readings()
    assert set(readings) == {"battery", "reach"}
    assert readings["battery"].value == 4_000 * 6.0 / 1000.0
    assert readings["reach"].value == -0.75


def test_a_reading_states_when_it_was_requested_and_when_it_came(bench: Bench) -> None:
    bench.runs(0.52)
    reading = bench.readings()["reach"]
    assert 0 < bench.world.now - reading.received_at <= 250 * MILLISECOND
    assert 0 < reading.received_at - reading.sampled_at < 50 * MILLISECOND


@pytest.mark.long(keeps=["on_can"])
def test_each_sensor_is_requested_at_its_own_pace(bench: Bench) -> None:
    bench.runs(1.5)
    before = bench.readings()
    bench.axes["left"].analogue_1_mv, bench.axes["left"].analogue_2_mv = 3_000, 500
    bench.runs(0.2)
    after = bench.readings()
    assert after["reach"].value == 0.25
    assert after["battery"] == before["battery"], "it is queried once a second"
    bench.runs(1.0)
    assert bench.readings()["battery"].value == 18.0


@pytest.mark.long(keeps=["on_line"])
def test_a_sensor_that_falls_silent_is_left_out(bench: Bench) -> None:
    bench.runs(0.5)
    silent_at = bench.world.now
    for axis in ("left", "right"):
        bench.world.silence(axis, silent_at)
    last = bench.readings()["reach"].received_at
    bench.world.run(last + 300 * MILLISECOND)
    assert "reach" in bench.readings()
    bench.world.run(last + 300 * MILLISECOND + 1)
    assert set(bench.readings()) == {"battery"}, "its silence of 5 s is not over yet"
    bench.runs(6.0)
    assert bench.readings() == {}


@pytest.mark.parametrize("make", [on_can, on_line])
def test_before_the_robot_runs_no_sensor_is_requested(make: Callable[[], AnyRobot]) -> None:
    bench = Bench(make())
    while not bench.host.running:
        assert bench.readings() == {}
        bench.runs(0.01)


@pytest.mark.long(keeps=["on_line"])
def test_the_pins_follow_their_levels(bench: Bench) -> None:
    assert pins(bench, "left") == pins(bench, "right") == 0
    bench.host.levels = {"lamp": ON, "horn": ON}
    bench.runs(0.15)
    assert (pins(bench, "left"), pins(bench, "right")) == (0b0001, 0b0010)
    bench.host.levels = {"lamp": OFF, "magnet": ON}
    bench.runs(0.15)
    assert (pins(bench, "left"), pins(bench, "right")) == (0b0100, 0b0010), "what is left out stays"
    bench.host.levels = {"magnet": OFF, "horn": OFF}
    bench.runs(0.15)
    assert pins(bench, "left") == pins(bench, "right") == 0


@pytest.mark.long(keeps=["on_can"])
def test_a_level_that_was_confirmed_is_not_written_again(bench: Bench) -> None:
    bench.host.levels = {"lamp": ON}
    bench.runs(0.3)
    written: list[int] = []
    bench.drives["left"].store.on_write(OUTPUT_STATE, written.append)
    bench.runs(0.5)
    assert written == []
    bench.host.levels = {"lamp": OFF}
    bench.runs(0.3)
    assert written == [0]


@pytest.mark.long(keeps=["on_can"])
def test_a_level_that_was_not_taken_is_written_until_it_is(bench: Bench) -> None:
    """The drives cannot be reached for a while; the pins then receive no command."""
    bench.runs(0.2)
    bench.world.silence(HOST, bench.world.now)
    bench.host.levels = {"lamp": ON, "horn": ON}
    bench.runs(0.5)
    assert pins(bench, "left") == pins(bench, "right") == 0
    bench.world.silence(HOST, NEVER)
    bench.runs(2.5)
    assert (pins(bench, "left"), pins(bench, "right")) == (0b0001, 0b0010)


class Once:
    """A third party on the bus who sends one frame."""

    def __init__(self, packet: Packet) -> None:
        self.sent: tuple[Packet, ...] = (packet,)

    def receive(self, _packet: Packet, _now: Nanoseconds) -> Reaction:
        return Reaction()

    def wake(self, _now: Nanoseconds) -> Reaction:
        sent, self.sent = self.sent, ()
        return Reaction(sent)


@pytest.mark.long(keeps=["on_can"])
def test_after_a_restart_the_outputs_come_back_with_the_set_up(bench: Bench) -> None:
    bench.host.levels = {"lamp": ON, "magnet": ON}
    bench.runs(0.2)
    bench.host.repairs = False
    reset = cia301.encode_nmt(NmtCommand.RESET_NODE, 1)
    bench.world.attach("foreign", Once(Packet(CAN, cia301.NMT, reset)), {CAN: bench.buses[LINK]})
    bench.runs(0.3)
    assert pins(bench, "left") == 0, "the mask is gone with the set-up"
    assert bench.feedback("left").power is Power.UNKNOWN
    bench.host.repairs = True
    bench.runs(2.5)
    assert bench.feedback("left").power is Power.ON
    assert pins(bench, "left") == 0b0101


class Bare:
    """A drive that takes requests, and ends them on command."""

    state, set_ups = DriverState.ACTIVE, 1

    def __init__(self) -> None:
        self.axis = changed(equipped).axes[0]
        self.requests: list[ObjectRequest] = []

    def request(self, request: ObjectRequest, _now: Nanoseconds) -> tuple[Packet, ...]:
        self.requests.append(request)
        return ()


REFUSED = SdoRefusedError(Transfer(at.ANALOGUE_INPUT_1), AbortCode.NO_OBJECT)
SILENT = SdoTimeoutError(Transfer(at.ANALOGUE_INPUT_1), 200 * MILLISECOND)


@pytest.mark.parametrize(
    ("outcome", "kept"), [(REFUSED, False), (b"\x01", False), (b"\x01\0\0\0", False), (SILENT, True)]
)
def test_what_a_drive_refuses_is_not_known_and_what_it_does_not_answer_grows_old(
    outcome: Outcome, *, kept: bool
) -> None:
    drive = Bare()
    sensor = ObjectSensor(changed(equipped).sensors[0], drive, VOLTAGE)
    sensor.measure(10)
    drive.requests[-1].end((500).to_bytes(2, "little"), 20)
    assert sensor.reading == Reading(3.0, 10, 20)
    sensor.measure(30)
    drive.requests[-1].end(outcome, 40)
    assert sensor.reading == (Reading(3.0, 10, 20) if kept else None)


def test_a_question_that_is_still_open_is_not_requested_again() -> None:
    drive = Bare()
    sensor = ObjectSensor(changed(equipped).sensors[0], drive, VOLTAGE)
    for now in (10, 20):
        sensor.measure(now)
    assert len(drive.requests) == 1
    drive.requests[0].over = True
    sensor.measure(30)
    assert len(drive.requests) == 2, "the drive dropped it"


LEVELS = st.dictionaries(st.sampled_from(("lamp", "magnet")), st.booleans())
ENDINGS = st.sampled_from(("taken", "refused", "dropped", "open", "set up"))


@given(st.lists(st.tuples(LEVELS, ENDINGS), max_size=30))
def test_whatever_happens_the_newest_levels_are_written_until_they_are_taken(
    steps: list[tuple[dict[str, bool], str]],
) -> None:
    """A drive's outputs, after a write that follows its newest set-up, are those wanted last."""
    drive = Bare()
    outputs = DigitalOutputs(changed(equipped).outputs[:2], drive)
    wanted, held, open_ = 0, None, 0
    bits = {"lamp": 0x8000, "magnet": 0x2000}
    for now, (levels, ending) in enumerate([*steps, ({}, "taken"), ({}, "taken"), ({}, "taken")]):
        for name, on in levels.items():
            wanted = wanted | bits[name] if on else wanted & ~bits[name]
        if ending == "set up":
            drive.set_ups += 1
            held = None
        outputs.switch({name: Level(on) for name, on in levels.items()}, now)
        assert len(drive.requests) - open_ <= 1, "one at a time"
        if len(drive.requests) == open_ or ending in {"open", "set up"}:
            continue
        request = drive.requests[-1]
        open_ = len(drive.requests)
        if ending == "taken":
            held = int.from_bytes(request.transfer.raw or b"", "little")
            request.end(b"", now)
        elif ending == "refused":
            request.end(REFUSED, now)
        else:
            request.over = True
    assert held == wanted


@pytest.mark.parametrize(
    ("change", "key", "problem"),
    [
        (
            lambda t: t["outputs"][1]["settings"].update(output=1),
            "outputs[1].settings.output",
            "1 is that of",
        ),
        (lambda t: t["outputs"][0]["settings"].update(axis="lift"), "outputs[0].settings.axis", "no axis"),
        (lambda t: t["outputs"][2].update(link="far"), "outputs[2].link", "the axis 'right' is on the link"),
        (lambda t: t["sensors"][0].update(link="far"), "sensors[0].link", "the axis 'left' is on the link"),
        (lambda t: t["outputs"][0]["settings"].update(output=5), "outputs[0].settings.output", "but it is 5"),
    ],
)
def test_a_pin_that_cannot_be_reached_is_refused_by_its_key(
    change: Callable[[dict[str, Any]], None], key: str, problem: str
) -> None:
    def wrong(table: dict[str, Any]) -> None:
        equipped(table)
        table["links"]["far"] = dict(table["links"][LINK])
        table["axes"].append(table["axes"][1] | {"name": "far", "role": "far", "link": "far"})
        change(table)

    with pytest.raises(RobotFileError) as refusal:
        changed(wrong)
    assert [(one.key, problem in one.problem) for one in refusal.value.problems] == [(key, True)]
