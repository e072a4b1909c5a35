"""The kernel's edges: its record, its place, and its error for a plant that fails."""

import ctypes
import subprocess
import sys
from pathlib import Path

import pytest

from emulators.servo import header, kernel
from emulators.servo.axis import ServoAxis
from emulators.servo.bank import ServoBank, ServoError, plant_inputs, plant_outputs
from emulators.servo.kernel import BankRecord, LineRecord
from emulators.servo.motor import DcMotor, DcMotors
from emulators.servo.record import FIELDS
from firmware_bridge.units import MILLISECOND
from fmu.build import ensure
from fmu.calls import STOPPED_SHORT, WANTS_TO_END, PlantRecord
from fmu.errors import PlantError
from fmu.plant import FmuPlant
from hil_tests.unit.servo.side_by_side import (
    COMPILERS,
    KERNEL,
    PLANT,
    REFERENCE,
    SANE,
    Leg,
    Motors,
    Side,
    compiled,
)

AXES = ("left", "right", "steer", "lift")


@pytest.fixture(scope="module")
def built(native: kernel.KernelLibrary) -> dict[str, kernel.KernelLibrary]:
    return {"reference": REFERENCE, "native": native}


def test_the_header_is_in_step_with_the_tables() -> None:
    assert header.PATH.read_text() == header.text(), "run python -m emulators.servo.header"


@pytest.mark.parametrize("compiler", COMPILERS)
def test_python_and_c_agree_where_each_field_lies(compiler: str, tmp_path: Path) -> None:
    records: dict[str, type[ctypes.Structure]] = {
        "servo_axis": ServoAxis,
        "servo_bank": BankRecord,
        "plant_calls": PlantRecord,
        "servo_line": LineRecord,
    }
    rows = [
        (f"offsetof({name}, {field[0]})", getattr(record, field[0]).offset)
        for name, record in records.items()
        for field in record._fields_
    ]
    rows += [(f"sizeof({name})", ctypes.sizeof(record)) for name, record in records.items()]
    checks = "\n".join(
        f"typedef char row{k}[{what} == {value} ? 1 : -1];" for k, (what, value) in enumerate(rows)
    )
    source = tmp_path / "layout.c"
    source.write_text(f'#include "kernel.h"\n#include <stddef.h>\n{checks}\n')
    command = [compiler, "-std=c99", "-fsyntax-only", f"-I{kernel.NATIVE_FOLDER}", str(source)]
    assert subprocess.run(command, check=False, capture_output=True, text=True).stderr == ""
    assert len(rows) > len(FIELDS)


@pytest.mark.long(keeps=["/usr/bin/gcc"])
@pytest.mark.parametrize("compiler", COMPILERS)
def test_the_kernel_compiles_without_a_warning(compiler: str, tmp_path: Path) -> None:
    flags = ("-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-Werror", "-O2")
    compiled(tmp_path, KERNEL, *flags, compiler=compiler)


def test_an_axis_takes_64_bits_and_no_fractions() -> None:
    axis = ServoAxis("one", 2000)
    axis.position_demand = -(2**63)
    assert axis.position_demand == -(2**63)
    with pytest.raises(TypeError):
        axis.position_demand = 0.5  # type: ignore[assignment] # what is refused here


def test_a_library_from_other_sources_is_not_used(tmp_path: Path) -> None:
    other = compiled(tmp_path, KERNEL, "-O0", "-DSERVO_SOURCE=1")
    assert kernel.load(other) == kernel.KernelLibrary(
        None, "its kernel was built from other sources (install this package again)"
    )
    assert "cannot be loaded" in kernel.load(PLANT[0]).reason


def test_the_environment_chooses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(kernel.VARIABLE, "reference")
    assert kernel.choose() == kernel.KernelLibrary(None, "the reference was requested")
    monkeypatch.setenv(kernel.VARIABLE, "fast")
    with pytest.raises(ServoError, match="FIRMWARE_BRIDGE_SERVO=fast: give 'native', 'reference'"):
        kernel.choose()
    monkeypatch.delenv(kernel.VARIABLE)
    assert kernel.choose() == kernel.find()


def test_a_kernel_that_is_requested_must_be_there(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kernel, "find", lambda: kernel.KernelLibrary(None, "its kernel was not built"))
    assert kernel.choose("").reason == "its kernel was not built"
    with pytest.raises(ServoError, match="cannot serve: its kernel was not built"):
        kernel.choose("native")


def test_a_plant_without_fmi_functions_is_stepped_by_the_reference(
    built: dict[str, kernel.KernelLibrary],
) -> None:
    bank = ServoBank(
        DcMotors((DcMotor(0.1, 1e-4, 0.04, 1e-4),)), [ServoAxis("one", 2000)], servo=built["native"]
    )
    assert not bank.native
    assert bank.why_not_native == "the plant has no FMI functions"


@pytest.mark.parametrize("side", ["reference", "native"])
@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize(
    ("failing", "stated"),
    [
        (1, "setting the inputs failed after 57 steps with 3"),
        (2, "doStep failed after 57 steps with 3"),
        (3, "reading the outputs failed after 57 steps with 3"),
    ],
)
def test_a_plant_that_fails_states_where_and_when(
    *,
    built: dict[str, kernel.KernelLibrary],
    plant_library: ctypes.CDLL,
    side: str,
    fmi: int,
    failing: int,
    stated: str,
) -> None:
    one = Side(Motors(plant_library, fmi), (SANE,) * 4, built[side])
    one.plant.breaks(at=57, failing=failing)
    with pytest.raises(PlantError, match=stated):
        one.runs(Leg((), 200))
    # The reading that fails is that of a step already taken.
    assert one.bank.now == (56 if failing == 3 else 57) * 100_000


@pytest.mark.parametrize("side", ["reference", "native"])
@pytest.mark.parametrize("failing", [WANTS_TO_END, STOPPED_SHORT])
def test_a_plant_that_ends_its_simulation_is_not_stepped_on(
    built: dict[str, kernel.KernelLibrary], plant_library: ctypes.CDLL, side: str, failing: int
) -> None:
    # FMI 3.0.1, 4.2.1: terminateSimulation, and earlyReturn, which no one has allowed.
    one = Side(Motors(plant_library, 3), (SANE,) * 4, built[side])
    one.plant.breaks(at=57, failing=failing)
    with pytest.raises(PlantError, match=f"doStep failed after 57 steps with {failing}"):
        one.runs(Leg((), 200))
    assert one.bank.now == 57 * 100_000


@pytest.mark.parametrize("value", [float("nan"), float("inf"), -1e300])
@pytest.mark.parametrize(
    ("replaced", "quantity"), [(0, "current"), (1, "angle"), (2, "speed"), (3, "supply")]
)
def test_what_is_no_measurement_is_refused_by_both_at_the_same_tick(
    built: dict[str, kernel.KernelLibrary],
    plant_library: ctypes.CDLL,
    replaced: int,
    quantity: str,
    value: float,
) -> None:
    stated, bits = [], []
    for found in built.values():
        # Shaken so much that an open winding is looked at in every tick.
        one = Side(Motors(plant_library, noise=1.0), (SANE,) * 4, found)
        one.plant.breaks(at=33, failing=4, replaced=replaced, replacement=value)
        with pytest.raises(ServoError, match=f"the plant's {quantity}.* at 0.00[34]") as refusal:
            one.runs(Leg((), 200))
        stated.append(str(refusal.value))
        bits.append((one.bits(), one.bank.now))
    assert stated[0] == stated[1]
    assert bits[0] == bits[1] or value != value  # noqa: PLR0124 - not a number is not equal to itself


def test_a_closed_plant_is_refused(built: dict[str, kernel.KernelLibrary]) -> None:
    plant = FmuPlant(ensure("rars"), plant_inputs(AXES), plant_outputs(AXES))
    bank = ServoBank(plant, [ServoAxis(name, 2000) for name in AXES], servo=built["native"])
    bank.advance(MILLISECOND)
    assert plant.steps_done == 10
    plant.close()
    with pytest.raises(PlantError, match="the plant is closed"):
        bank.advance(2 * MILLISECOND)


@pytest.mark.long(keeps=["3"])
@pytest.mark.parametrize("fmi", [2, 3])
def test_the_robots_plant_turns_alike_under_both(built: dict[str, kernel.KernelLibrary], fmi: int) -> None:
    seen = []
    for found in built.values():
        with FmuPlant(
            ensure("rars", fmi), plant_inputs(AXES), (*plant_outputs(AXES), "battery_voltage")
        ) as plant:
            axes = [ServoAxis(name, 2000) for name in AXES]
            bank = ServoBank(plant, axes, supply=12, servo=found)
            for axis in axes:
                axis.switch_on()
                axis.current_p, axis.current_i, axis.current_setting_ma, axis.regulator = 100, 20, 700, 1
                axis.peak_ma = axis.continuous_ma = 1000
                axis.speed_limit = 1 << 29
            while bank.now < 300 * MILLISECOND:
                bank.advance(300 * MILLISECOND)
            seen.append((list(plant.outputs), [bytes(axis) for axis in axes], plant.steps_done))
    assert seen[0] == seen[1]
    assert seen[0][2] == 3000


@pytest.mark.skipif(sys.platform == "win32", reason="the test's plant is compiled as on Unix")
def test_the_drive_of_this_package_is_native_when_its_kernel_is_built() -> None:
    built = (Path(kernel.__file__).parent / kernel.LIBRARY).exists()
    assert (kernel.find().library is not None) == built, kernel.find().reason
