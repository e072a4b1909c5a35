"""Trust of `drive` in its peers: key files, lists of addresses, and links that reach beyond this machine."""

import hashlib
import ipaddress
import os
from pathlib import Path

import pytest
import typer

from firmware_bridge.cli.trusted import key_in, trust_of
from firmware_bridge.units import SECOND

DIGITS = bytes(range(32)).hex()
HERE = "udpin:127.0.0.1:14550"


@pytest.fixture
def key_file(tmp_path: Path) -> Path:
    return written(tmp_path, DIGITS)


def written(folder: Path, text: str, mode: int = 0o600) -> Path:
    file = folder / "rars.key"
    file.write_text(text)
    file.chmod(mode)
    return file


@pytest.mark.parametrize("link", [HERE, "udpin:[::1]:14550", "udpout:127.0.0.5:14550", "udpin:localhost:1"])
def test_a_link_on_this_machine_needs_no_key(link: str) -> None:
    assert trust_of(link, None, None, openly=False).key is None


BEYOND = [
    "udpin:0.0.0.0:14550",
    "udpin::14550",
    "udpin:[::]:14550",
    "udpout:192.0.2.1:14550",
    "udpin:192.0.2.1:1",
]


@pytest.mark.parametrize("link", BEYOND)
def test_a_link_beyond_this_machine_needs_a_key_or_to_be_open(
    link: str, key_file: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(typer.Exit) as ended:
        trust_of(link, None, ["192.0.2.1"], openly=False)
    assert ended.value.exit_code == 2
    [line] = capsys.readouterr().err.splitlines()
    assert f"--mavlink {link}: " in line
    assert "--key FILE" in line
    assert "--open" in line
    assert trust_of(link, None, None, openly=True).key is None
    assert trust_of(link, key_file, None, openly=False).key == bytes(range(32))


def test_a_key_is_digits_or_a_phrase(tmp_path: Path) -> None:
    assert key_in(written(tmp_path, f"\n{DIGITS.upper()}\n")) == bytes(range(32))
    assert key_in(written(tmp_path, "correct horse\n")) == hashlib.sha256(b"correct horse").digest()


@pytest.mark.parametrize("text", ["", "short", "eleven only", "two lines\nof some length", "0" * 64])
def test_what_is_no_key_is_refused(tmp_path: Path, text: str, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit):
        key_in(written(tmp_path, text))
    assert "must hold 64 hexadecimal digits" in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="files have no such modes")
@pytest.mark.parametrize("mode", [0o640, 0o604, 0o620])
def test_a_key_that_others_can_read_is_refused(
    tmp_path: Path, mode: int, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(typer.Exit):
        key_in(written(tmp_path, DIGITS, mode))
    assert "chmod 600" in capsys.readouterr().err


def test_a_key_file_that_is_missing_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(typer.Exit):
        key_in(tmp_path / "none.key")
    assert "none.key: cannot be read: No such file" in capsys.readouterr().err


def test_a_list_names_addresses_and_networks(capsys: pytest.CaptureFixture[str]) -> None:
    trust = trust_of(HERE, None, ["192.0.2.7", "10.0.0.0/24"], openly=False)
    assert trust.allowed == (ipaddress.ip_network("192.0.2.7/32"), ipaddress.ip_network("10.0.0.0/24"))
    for wrong in ("robot", "10.0.0.1/24", "10.0.0.1:14550", ""):
        with pytest.raises(typer.Exit):
            trust_of(HERE, None, [wrong], openly=False)
        assert f"--allow {wrong}: give an address" in capsys.readouterr().err


def test_a_key_and_open_contradict_each_other(key_file: Path) -> None:
    with pytest.raises(typer.Exit):
        trust_of(HERE, key_file, None, openly=True)


def test_stamps_begin_with_the_machines_time() -> None:
    assert trust_of(HERE, None, None, openly=False).started_at > 1_700_000_000 * SECOND
