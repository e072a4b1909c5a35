"""Documents of the emulated EPOS2 at the command line: `epos2 objects`, `eds`, `dcf`, `fidelity`."""

from pathlib import Path
from typing import Annotated, Final

import typer
from rich.table import Table

from emulators.epos2.commands.options import ProfileOption, find_profile
from emulators.epos2.documents import eds as sheets
from emulators.epos2.documents import fidelity as known
from emulators.epos2.documents import object_table as dictionary
from emulators.epos2.documents.object_reader import SilentNodeError, read_all
from emulators.epos2.objects.catalogue import PROFILES
from emulators.epos2.objects.device_profile import BIT_RATE_IN_USE, BIT_RATES, numbered
from firmware_bridge.canopen import objects as od
from firmware_bridge.canopen.cia301 import FIRST_NODE, LAST_NODE
from firmware_bridge.cli.commands import command
from firmware_bridge.cli.console import FAILED, one_message, refusal, say, written_by
from firmware_bridge.cli.options import BitRateOption, ChannelOption, InterfaceOption
from firmware_bridge.cli.tables import print_grid, print_lines, terminal
from firmware_bridge.runtime.ports import LostPort, PortError, open_can

EXAMPLES: Final = """Examples:

`firmware-bridge epos2 objects target` lists those with it in their names, `objects 0x607A` shows one.

`firmware-bridge epos2 eds --out epos2.eds`

`firmware-bridge epos2 dcf --node 1 -i socketcan -c vcan0 --out node1.dcf`

`firmware-bridge epos2 fidelity`"""

OutOption = Annotated[
    Path | None,
    typer.Option("--out", "-o", metavar="FILE", help="Output file.", show_default="to the terminal"),
]
NodeOption = Annotated[int, typer.Option("--node", "-n", min=FIRST_NODE, max=LAST_NODE, help="Its number.")]


@command(EXAMPLES)
def objects(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[TEXT]...",
            help="Only objects with all of these in address or name; a single one is shown in full.",
            show_default=False,
        ),
    ] = None,
    *,
    profile: ProfileOption = "70/10",
    node: NodeOption = 1,
    json: Annotated[bool, typer.Option("--json", help="Output for programs, as JSON.")] = False,
) -> None:
    """List every object: type, access, PDO, range, default, and provenance."""
    found = numbered(find_profile(profile), node)
    if json:
        say(dictionary.as_json(found, node))
        return
    entries = [one for one in dictionary.entries(found, node) if one.matches(words or ())]
    if not entries:
        raise refusal(f"the {found.name} has no object with {' and '.join(words or ())} in address or name")
    if len(entries) == 1:
        print_grid(zip(dictionary.HEADINGS, entries[0].cells(), strict=True))
        return
    say(f"objects of the {found.name}, node {node}; `epos2 objects TEXT` shows those with it, one in full")
    print_lines((dictionary.LINE, *(one.line() for one in entries)), dictionary.NAME)


@command(EXAMPLES)
def eds(*, profile: ProfileOption = "70/10", out: OutOption = None) -> None:
    """Write the electronic data sheet, for any CANopen master's tools."""
    name = out.name if out else "epos2.eds"
    _deliver(sheets.eds(find_profile(profile), name), out)


@command(EXAMPLES)
def dcf(
    *,
    node: NodeOption = 1,
    interface: InterfaceOption = None,
    channel: ChannelOption = None,
    bit_rate: BitRateOption = None,
    out: OutOption = None,
) -> None:
    """Read every object of a running drive, emulated or real, and write its device configuration file."""
    with one_message(PortError):
        port = open_can(interface, channel, bit_rate, say=say)
    with one_message(SilentNodeError, LostPort, status=FAILED):
        values = read_all(port, node)
    by_product = {(profile.hardware_version or 0) << 16: profile for profile in PROFILES.values()}
    product = values.get(od.PRODUCT_CODE)
    found = by_product.get(product if isinstance(product, int) else -1, PROFILES["70/10"])
    code = values.get(BIT_RATE_IN_USE, 0)
    rate = bit_rate or BIT_RATES.get(code if isinstance(code, int) else 0, 1_000_000)
    _deliver(sheets.dcf(found, node, rate, values, out.name if out else "epos2.dcf"), out)


@command(EXAMPLES)
def fidelity(
    words: Annotated[
        list[str] | None,
        typer.Argument(metavar="[TEXT]...", help="Only lines with all of these.", show_default=False),
    ] = None,
    *,
    every: Annotated[bool, typer.Option("--all", help="Include proven items.")] = False,
) -> None:
    """List proven, documented, analogous and assumed parts of the emulation, with their sources."""
    counts = Table(title="how far the emulated EPOS2 is known")
    for heading in ("part", *(each.value for each in known.ORDER)):
        counts.add_column(heading)
    for part, found in known.counted().items():
        counts.add_row(part, *(str(found[each] or "") for each in known.ORDER))
    table = Table(box=None, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("known", no_wrap=True)
    table.add_column("what, and from where", overflow="fold")
    for line in known.ledger():
        text = f"{line.part}: {line.what} ({line.source})"
        wanted = all(word.casefold() in text.casefold() for word in words or ())
        if wanted and (every or line.provenance is not known.ORDER[0]):
            table.add_row(line.provenance.value, text)
    if not words:
        terminal().print(counts)
    terminal().print(table)


def _deliver(text: str, out: Path | None) -> None:
    if out is None:
        say(text)
        return
    with written_by("--out"):
        out.write_text(text + "\n", encoding="ascii")
    say(f"written: {out}", err=True)
