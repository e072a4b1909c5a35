"""`--record`: the black box of `drive` and of `emulate`."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, TypeAlias

import typer

from firmware_bridge.cli.console import one_message, refusal, say
from firmware_bridge.extras import ExtraMissingError, from_extras
from firmware_bridge.mcap_file.channels import SUFFIX
from firmware_bridge.node import Node
from firmware_bridge.recording import Recorded
from firmware_bridge.runtime.black_box import CAN_LOG, BlackBox, BlackBoxError, Texts, no_texts
from firmware_bridge.runtime.can_files import OF_FRAMES

if TYPE_CHECKING:
    from firmware_bridge.mcap_file.bridge_watch import BridgeWatch
    from firmware_bridge.runtime.can_box import CanBox
    from firmware_bridge.runtime.mcap_box import McapBox

RecordOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER|FILE",
        help="Record the run in a new folder there: can.log or serial.log, capture.log with cameras, "
        "operator.tlog, and events.log with the stations that armed, drove and stopped. A name that ends in "
        ".mcap is a new file for Foxglove or PlotJuggler, in .asc, .blf or .trc one of CAN frames for the "
        "tools of Vector and PEAK. A full disk ends the recording, never the run.",
        show_default=False,
    ),
]
Say: TypeAlias = Callable[[str], None]
Around: TypeAlias = Callable[[Node], Node]


@contextmanager
def recording(
    folder: Path | None,
    files: Mapping[str, str],
    texts: Texts = no_texts,
    called: Mapping[str, str] = MappingProxyType({}),
    known: Mapping[str, str] = MappingProxyType({}),
    *,
    watch: "BridgeWatch | None" = None,
) -> Iterator[tuple[Around, Say]]:
    """Give the wrapper of the carried node, and the user's output; without a folder, nothing is recorded.

    `folder` may be a file in MCAP, or of CAN frames. `called` has names that links have in a log of lines;
    `known`, by the names of files, the program's knowledge before; `watch` shows the bridge, for a file in
    MCAP. What cannot be made, or needs an extra that is missing, ends the program with a message.
    """
    if folder is None:
        yield (lambda node: node), say
        return
    with_bus(folder, has_bus=CAN_LOG in files.values(), instead="a name that ends in .mcap, or a folder,")
    with one_message(BlackBoxError, ExtraMissingError):
        box: BlackBox | McapBox | CanBox
        if folder.suffix.lower() == SUFFIX:
            box, place = _in_file(folder, files, called, known, watch=watch), folder
        elif folder.suffix.lower() in OF_FRAMES:
            box, place = _of_frames(folder, files), folder
        else:
            box = BlackBox(folder, files, say, texts, called, known=known)
            place = box.folder
    with box:
        say(f"recording in {place}")
        yield (lambda node: Recorded(node, box.note)), box.report


def with_bus(path: Path, *, has_bus: bool, instead: str) -> None:
    """End the program with a message for a file of CAN frames, where no link of the run is a bus."""
    if path.suffix.lower() in OF_FRAMES and not has_bus:
        raise refusal(f"--record {path}: has CAN frames only, and this run has no bus; {instead} has lines")


def _of_frames(path: Path, files: Mapping[str, str]) -> "CanBox":
    from firmware_bridge.runtime.can_box import CanBox

    return CanBox(path, files, say)


def _in_file(
    path: Path,
    files: Mapping[str, str],
    called: Mapping[str, str],
    known: Mapping[str, str],
    *,
    watch: "BridgeWatch | None",
) -> "McapBox":
    with from_extras():
        from firmware_bridge.runtime.mcap_box import McapBox

        return McapBox(path, files, say, called, known=known, watch=watch)
