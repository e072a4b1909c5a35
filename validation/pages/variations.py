"""The plain servo's page: difficult but lawful drives by name, and the emulation's own assumptions."""

from typing import Final

from emulators.cia402.variations import VARIATIONS
from validation.masters.starts import MASTERS, outcome
from validation.pages import board_fidelity
from validation.pages.capture_fidelity import Table

TITLE: Final = "Variations of the emulated CiA 402 servo"
FOLDER: Final = "cia402"
TEXT: Final = (
    "[`emulate cia402`](clients.md) puts a servo of no maker on a bus. Drives in the field are lawful, and "
    "yet do what masters do not expect: with `--variation NAME[,NAME]` it does that, too. Without one it "
    "does what the standard has."
)
MASTERS_TEXT: Final = (
    "The start sequences of four masters, by their sources, played against each: until the motor turns in "
    "profile velocity mode, or until the master gives up, with what it reports. Lely alone boots and "
    "configures. None of these programs was run for this table; canopen itself drives the servo in a test."
)


def _named(name: str) -> tuple[str, ...]:
    return (name,) if name else ()


def parts(table: Table) -> tuple[str, ...]:
    """Return the page's title and its parts; `table` makes a table of headings and rows."""
    return (
        TITLE,
        TEXT,
        table(
            ("variation", "what it does", "seen", "the bridge"),
            ((f"`{name}`", row.text, row.seen, row.bridge) for name, row in VARIATIONS.items()),
        ),
        "## Masters in the field",
        MASTERS_TEXT,
        table(
            ("variation", *MASTERS),
            (
                (f"`{name}`" if name else "none", *(outcome(master, *_named(name)) for master in MASTERS))
                for name in ("", *VARIATIONS)
            ),
        ),
        "## Stated assumptions",
        table(("assumption", "file"), board_fidelity.assumptions(FOLDER)),
    )
