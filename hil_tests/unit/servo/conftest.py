"""The plant of the tests and the kernel, compiled once from the sources as they are now."""

import ctypes

import pytest

from emulators.servo import kernel
from hil_tests.unit.servo.side_by_side import KERNEL, PLANT, compiled


@pytest.fixture(scope="session")
def plant_library(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return ctypes.CDLL(str(compiled(tmp_path_factory.mktemp("plant"), PLANT, "-O2")))


@pytest.fixture(scope="session")
def native(tmp_path_factory: pytest.TempPathFactory) -> kernel.KernelLibrary:
    """The kernel as its sources are now, whatever the package's build has left."""
    return kernel.load(compiled(tmp_path_factory.mktemp("kernel"), KERNEL, "-O2"))
