"""As many lines as are requested, to the sketch's binary and to the emulator; `make compare-sketch`."""

import sys
from argparse import ArgumentParser
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from hil_tests.interop.simavr.comparison import Binary, Emulated, built, differences
from hil_tests.interop.simavr.lines import happening

AT_ONCE: Final = 5_000
"""Lines to one board, before both begin again."""
SHOWN: Final = 5


def main() -> int:
    """Run them; return 1 where something was not the same."""
    parser = ArgumentParser(description=__doc__)
    parser.add_argument("lines", type=int)
    parser.add_argument("--seed", type=int, default=1_000)
    words = parser.parse_args()
    with TemporaryDirectory() as folder:
        made = built(Path(folder))
        for number, begun in enumerate(range(0, words.lines, AT_ONCE)):
            seed, lines = words.seed + number, min(AT_ONCE, words.lines - begun)
            with Binary(*made) as binary:
                found = list(islice(differences(binary, Emulated(), happening(seed, lines)), SHOWN))
            print(f"seed {seed}: {lines} lines, {'the same' if not found else 'not the same'}", flush=True)  # noqa: T201
            if found:
                print("\n".join(found))  # noqa: T201
                return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
