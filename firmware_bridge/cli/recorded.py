"""`--record`: the black box of `drive` and of `emulate`."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import MappingProxyType
from typing import Annotated, TypeAlias

import typer

from firmware_bridge.cli.console import one_message, say
from firmware_bridge.node import Node
from firmware_bridge.recording import Recorded
from firmware_bridge.runtime.black_box import BlackBox, BlackBoxError, Texts, no_texts

RecordOption = Annotated[
    Path | None,
    typer.Option(
        metavar="FOLDER",
        help="Record the run in a new folder there: can.log or serial.log, capture.log with cameras, "
        "operator.tlog, and events.log with the stations that armed, drove and stopped. A full disk ends "
        "the recording, never the run.",
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
) -> Iterator[tuple[Around, Say]]:
    """Give the wrapper of the carried node, and the user's output; without a folder, nothing is recorded.

    `called` has names that links have in a log of lines; `known`, by the names of files, the program's
    knowledge before. A folder that cannot be made ends the program with a message.
    """
    if folder is None:
        yield (lambda node: node), say
        return
    with one_message(BlackBoxError):
        box = BlackBox(folder, files, say, texts, called, known=known)
    with box:
        say(f"recording in {box.folder}")
        yield (lambda node: Recorded(node, box.note)), box.report
