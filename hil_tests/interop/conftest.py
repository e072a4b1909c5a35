"""The data sheet that a third party is given."""

from pathlib import Path

import pytest

from emulators.epos2.documents.eds import eds
from emulators.epos2.objects.device_profile import EPOS2_70_10


@pytest.fixture(scope="session")
def sheet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("eds") / "epos2.eds"
    path.write_text(eds(EPOS2_70_10), encoding="ascii")
    return path
