# ruff: noqa: INP001 - a script's neighbor, not a package
"""Modules to break, in their order, and the tests that must notice."""

import ast
import hashlib
from collections.abc import Iterator, Sequence
from fnmatch import fnmatch
from functools import cache
from pathlib import Path
from typing import Final

from mutants import ROOT, mutants, path_of

TESTS: Final = ROOT / "hil_tests"
OPERATORS: Final = ("breaks.py", "mutants.py")

GUARD: Final = tuple(
    f"safety/test_guard_{what}" for what in ("power", "watch", "frames", "writes", "reports")
)
LINES: Final = tuple(f"safety/test_guard_serial{what}" for what in ("", "_answers", "_rules"))
ACROSS: Final = tuple(
    f"safety/test_guard_{what}" for what in ("across_rules", "exclusive", "links", "sums", "homing", "shield")
)
FOLLOWING: Final = tuple(f"safety/test_following{what}" for what in ("", "_power", "_homing", "_halted"))
GATE: Final = (
    *(f"safety/test_gate_{what}" for what in ("lift", "limits", "rows", "stops")),
    "safety/test_what_follows",
)

EPOS2_DRIVER: Final = ("unit/drivers/*", "unit/serial_drive/*")
HOMING: Final = ("unit/bridge/test_homing", "scenarios/test_homing_stories")

PACKAGES: Final[tuple[tuple[str, tuple[str, ...]], ...]] = (
    ("safety/guard/guard", (*GUARD, *LINES, *ACROSS)),
    ("safety/guard/across_axes", ACROSS),
    ("safety/guard/one_axis", ("safety/test_guard_one_axis",)),
    ("canopen_drive/guard/bounds", ("safety/test_guard_bounds",)),
    ("families/epos2/guard/serial", (*LINES, "safety/test_guard_reports", *ACROSS, "safety/test_guard_zero")),
    ("families/motion_capture/guard", ("safety/test_guard_capture",)),
    ("families/imu/guard", ("unit/imu/test_imu_on_robot",)),
    (
        "canopen_drive/guard/zeroing",
        ("safety/test_guard_zero", "safety/test_guard_homing", "safety/test_guard_zeroing_state"),
    ),
    (
        "canopen_drive/guard/axis",
        ("safety/test_guard_axis_state", *GUARD, *ACROSS, "safety/test_guard_zero", *LINES),
    ),
    (
        "families/motor_shield/guard/*",
        tuple(f"safety/test_guard_shield{what}" for what in ("", "_motors", "_words")),
    ),
    ("families/ar2/guard", ("safety/test_guard_ar2", "safety/test_guard_ar2_rules")),
    ("canopen_drive/guard/*", (*GUARD, *ACROSS, "safety/test_guard_zero", *LINES)),
    ("families/epos2/guard/*", (*GUARD, *ACROSS, "safety/test_guard_zero", *LINES)),
    ("safety/guard/*", (*GUARD, *ACROSS, "safety/test_guard_zero", *LINES)),
    ("safety/tracking", (*FOLLOWING, "unit/pipeline/test_untrusted")),
    ("safety/snapshot", ("safety/test_snapshot", *FOLLOWING, *GATE)),
    ("safety/charge", ("unit/pipeline/test_charge",)),
    ("safety/operator_interlocks", (*GATE, "safety/test_one_cause_one_hold", "safety/test_snapshot")),
    ("safety/rules", (*GATE, "safety/test_rules", "unit/pipeline/test_rest")),
    (
        "safety/*",
        (*GATE, "safety/test_weaker_rows", "safety/test_snapshot", "safety/test_rows_as_a_table"),
    ),
    ("bridge/*", ("unit/bridge/*", "unit/pipeline/*")),
    ("families/motion_capture/driver/*", ("unit/capture_driver/*",)),
    ("families/imu/driver/*", ("unit/imu/test_attitude", "unit/imu/test_imu_line")),
    ("families/epos2/commissioning/*", ("unit/commissioning/*",)),
    (
        "families/epos2/driver/serial/*",
        (*EPOS2_DRIVER, "scenarios/test_serial_drive", "scenarios/test_serial_two_programs"),
    ),
    (
        "families/ar2/driver/*",
        ("unit/ar2_driver/*", "unit/drivers/test_lost_board", "scenarios/test_ar2_stories"),
    ),
    (
        "families/motor_shield/driver/*",
        ("unit/shield/*", "unit/drivers/test_lost_board", "failures/test_failures"),
    ),
    ("canopen_drive/driver/stops", ("unit/bridge/*", "unit/drivers/*")),
    ("drivers/*stop*", ("unit/bridge/*", "unit/drivers/*")),
    (
        "canopen_drive/driver/task_runner",
        (*EPOS2_DRIVER, "unit/bridge/*", *HOMING, "scenarios/test_people_stories"),
    ),
    ("canopen_drive/driver/zero", (*EPOS2_DRIVER, "unit/bridge/test_zero", *HOMING)),
    ("canopen_drive/driver/tasks", (*EPOS2_DRIVER, "unit/bridge/*", *HOMING)),
    ("canopen_drive/driver/feedback", (*EPOS2_DRIVER, "unit/bridge/*", *HOMING)),
    ("canopen_drive/driver/*", EPOS2_DRIVER),
    ("families/epos2/driver/*", EPOS2_DRIVER),
    ("canopen/sdo_client", ("unit/drivers/*", "unit/serial_drive/*")),
    ("drivers/request_line", ("unit/drivers/test_request_line*",)),
    ("drivers/*", ("unit/drivers/*", "unit/serial_drive/*")),
    ("motion/model", ("unit/motion/test_model", "unit/pilot/test_predictor")),
    ("motion/*", ("unit/motion/*",)),
    ("robots/*/station", ("unit/teleop/*",)),
    ("robots/rars/model", ("unit/pilot/test_predictor",)),
    ("robots/rars/modes", ("robots/test_rars_modes",)),
    ("robots/ar2/arm", ("unit/motion/*",)),
    ("robots/ar2/*", ("scenarios/test_ar2_stories",)),
    ("robots/rome_arm/*", ("robots/test_rome_arm", "scenarios/test_rome_arm_stories")),
    ("robots/rome/*", ("robots/test_rome", "robots/test_rome_cameras")),
    ("robots/*", (*GATE, "robots/test_rars_body", "unit/motion/*", "unit/pipeline/test_rest")),
    ("differential/*", ("robots/test_diff_drive*",)),
    ("diff_drive/*", ("robots/test_diff_drive*",)),
    ("teleop/*", ("unit/teleop/*",)),
    ("mavlink/*", ("unit/teleop/*",)),
)
"""Modules of `firmware_bridge` or an example, and files of `hil_tests`; what stands first counts."""
SLOW: Final = ("*_property", "*_imports", "*_machine", "*_garbage", "*_emulated_*", "*/test_any_sender")
"""Files that never count: one of them takes as long as all others of its room."""
NONE: Final = ("diff_drive/plant/*", "diff_drive/bench_setup", "diff_drive/cases", "toy_drive/*")
"""The bench's half of an example, and an example that is made up."""


def targets() -> Iterator[str]:
    """Yield the modules, in the order of the packages."""
    ours = ROOT / "firmware_bridge"
    files = [(file, ours) for file in ours.rglob("*.py")]
    files += [(file, file.parents[1]) for file in ROOT.glob("examples/*/src/*/*.py")]
    names = sorted(str(file.relative_to(above).with_suffix("")) for file, above in files)
    for pattern, _ in PACKAGES:
        for name in names:
            if _row_of(name) == pattern and next(mutants(name), None) is not None:
                yield name


def tests_of(target: str) -> tuple[Path, ...]:
    """Return the files of tests that must notice a target's mutants."""
    patterns = dict(PACKAGES)[_row_of(target)]
    files = (file for pattern in patterns for file in sorted(TESTS.glob(f"{pattern}.py")))
    return tuple(
        dict.fromkeys(
            file
            for file in files
            if file.name.startswith("test_")
            and not any(fnmatch(str(file.with_suffix("")), slow) for slow in SLOW)
        )
    )


def named_for(target: str) -> tuple[Path, ...]:
    """Return those of them that the table names, one by one."""
    return tuple(TESTS / f"{name}.py" for name in dict(PACKAGES)[_row_of(target)] if "*" not in name)


def hashes_of(target: str) -> tuple[str, str, str]:
    """Return the hashes of a module, of its tests and what stands beside them, and of how it is broken."""
    tests = tests_of(target)
    beside = {
        file for test in tests for file in test.parent.glob("*.py") if not file.name.startswith("test_")
    }
    operators = [Path(__file__).with_name(name) for name in OPERATORS]
    return _hash([path_of(target)]), _hash([*tests, *sorted(beside)]), _hash(operators)


def _row_of(target: str) -> str:
    if any(fnmatch(target, pattern) for pattern in NONE):
        return ""
    return next((pattern for pattern, _ in PACKAGES if fnmatch(target, pattern)), "")


def _hash(files: Sequence[Path]) -> str:
    """Return a hash of what is done in some files; comments and their places do not count."""
    digest = hashlib.sha256()
    for file in files:
        digest.update(_done_in(file).encode())
    return digest.hexdigest()[:12]


def _done_in(file: Path) -> str:
    return _parsed(file, file.stat().st_mtime_ns)


@cache
def _parsed(file: Path, _changed_at: int) -> str:
    return ast.dump(ast.parse(file.read_text(encoding="utf-8")))
