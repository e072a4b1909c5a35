"""Choices that the sources leave open: each can be made, and a wrong one is refused in one line."""

import pytest

from emulators.epos2.documents.fidelity import ledger
from emulators.epos2.objects.choices import CHOICES, ChoiceError, chosen
from emulators.epos2.objects.device_profile import EPOS2_70_10
from firmware_bridge.canopen.abort import AbortCode
from firmware_bridge.units import MILLISECOND
from hil_tests.rows import every
from hil_tests.unit.epos2.quiet_motion import powered, u32


@every("name", CHOICES)
def test_each_default_is_read_as_it_is_written(name: str) -> None:
    choice = CHOICES[name]
    assert choice.read(choice.text) == choice.default == getattr(EPOS2_70_10, choice.field)
    assert chosen(EPOS2_70_10, [f"{name}={choice.text}"]) == EPOS2_70_10


@every("name", CHOICES)
def test_each_choice_is_on_the_ledger_with_default_and_evidence(name: str) -> None:
    (line,) = [line for line in ledger() if line.what == f"{name}={CHOICES[name].text}"]
    assert (line.provenance, line.source) == (CHOICES[name].known.provenance, CHOICES[name].known.source)
    assert line.source


def test_choices_are_made() -> None:
    profile = chosen(
        EPOS2_70_10,
        [
            "mapping-needs-invalid-pdo=yes",
            "boot-time=1.5s",
            "wrong-signature=0x08000020",
            "beyond-size=01020304",
        ],
    )
    assert profile.mapping_needs_invalid_pdo is True
    assert profile.boot_time == 1500 * MILLISECOND
    assert profile.wrong_signature is AbortCode.CANNOT_STORE
    assert profile.beyond_size == b"\1\2\3\4"


@pytest.mark.parametrize(("choice", "answer"), [("no", "ok"), ("yes", "06010000")])
def test_a_choice_is_what_the_drive_does(choice: str, answer: str) -> None:
    desk = powered(chosen(EPOS2_70_10, [f"mapping-needs-invalid-pdo={choice}"]))
    assert desk.writes(0x1600, 0, b"\0") == answer
    assert desk.writes(0x1010, 1, u32(1)) == "0F00FFBE"


@pytest.mark.parametrize(
    ("text", "stated"),
    [
        ("maping-needs-invalid-pdo=no", "did you mean mapping-needs-invalid-pdo"),
        ("color=blue", "there are: "),
        ("mapping-needs-invalid-pdo", "give yes or no; it is no by default"),
        ("mapping-needs-invalid-pdo=maybe", "give yes or no"),
        ("boot-time=300", "give a time, as 300ms; it is 0ms by default"),
        ("boot-time=-1ms", "give a time"),
        ("boot-time=61s", "give a time"),
        ("poll=0ms", "give a time"),
        ("gateway-segment=64", "give a whole number"),
        ("gateway-segment=0", "give a whole number"),
        ("beyond-size=00", "give four bytes"),
        ("wrong-signature=0x12345678", "give an abort code"),
        ("bit-rate=3", "there is no choice 'bit-rate'"),
    ],
)
def test_what_is_no_choice_is_refused(text: str, stated: str) -> None:
    with pytest.raises(ChoiceError, match=stated) as refusal:
        chosen(EPOS2_70_10, [text])
    assert str(refusal.value).startswith(f"--choice {text}: ")
    assert "\n" not in str(refusal.value)
