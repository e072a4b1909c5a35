"""The bus description of docs/clients.md: Lely's dcfgen makes a configuration of it, and a drive takes it.

ros2_canopen makes its configuration by the same tool, and its master writes the result entry by entry.
"""

import re
import struct
import subprocess
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Final

import pytest

from emulators.epos2.documents.eds import eds
from emulators.epos2.objects.device_profile import EPOS2_70_10
from hil_tests.interop.test_canopen_master import NODE, Bench
from hil_tests.interop.test_canopen_master import bench as bench  # noqa: PLC0414 - a fixture

PAGE: Final = Path(__file__).parents[2] / "docs" / "clients.md"
RUN: Final = """
import importlib.util, pathlib, sys, types
# dcfgen finds its templates by a module that setuptools no longer has.
paths = types.ModuleType("pkg_resources")
paths.resource_filename = lambda package, name: str(
    pathlib.Path(importlib.util.find_spec(package).origin).parent / name
)
sys.modules["pkg_resources"] = paths
from dcfgen.cli import main
sys.argv = ["dcfgen", "-r", "bus.yml"]
main()
"""


def entries(concise: bytes) -> Iterator[tuple[int, int, bytes]]:
    """Yield index, subindex and value of each entry of a concise DCF (CiA 302)."""
    (count,) = struct.unpack_from("<I", concise)
    place = 4
    for _ in range(count):
        index, sub, size = struct.unpack_from("<HBI", concise, place)
        place += 7
        yield index, sub, concise[place : place + size]
        place += size
    assert place == len(concise)


@pytest.mark.interpreted  # what is installed beside the compiled core has no such tools
@pytest.mark.skipif(find_spec("dcfgen") is None, reason="Lely's dcf-tools are not installed")
def test_a_drive_takes_what_is_made_of_the_bus_description(bench: Bench, tmp_path: Path) -> None:
    (described,) = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    (tmp_path / "bus.yml").write_text(described, encoding="utf-8")
    (tmp_path / "epos2.eds").write_text(eds(EPOS2_70_10), encoding="ascii")
    done = subprocess.run(
        [sys.executable, "-c", RUN], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    written = list(entries((tmp_path / "wheel.bin").read_bytes()))
    assert {0x1600, 0x1601, 0x1A00, 0x1A01} <= {index for index, _, _ in written}
    node = bench.node
    for index, sub, value in written:
        node.sdo.download(index, sub, value)
    assert node.sdo.upload(0x1600, 1) == bytes.fromhex("10004060")
    assert node.sdo.upload(0x1601, 2) == bytes.fromhex("2000ff60")
    assert node.sdo.upload(0x1A01, 1) == bytes.fromhex("20006460")
    valid = int.from_bytes(node.sdo.upload(0x1801, 1), "little")
    assert (valid >> 31, valid & 0x7FF) == (0, 0x280 + NODE)
