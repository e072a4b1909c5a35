"""The mark of values that are made by the dozen in every cycle.

To mypy they are frozen dataclasses, and enforces it. Where the program runs they are plain ones, with a hash
that promises the same: those cost a sixth to make, and half where the core is compiled. mypyc takes the mark
for the dataclass that mypy sees, and evaluates it; so this module itself is not translated.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from dataclasses import dataclass as valueclass
else:
    from dataclasses import dataclass

    def valueclass(*, frozen: bool, slots: bool, kw_only: bool = False) -> object:
        """Return the decorator; `frozen` is mypy's matter."""
        return dataclass(unsafe_hash=frozen, slots=slots, kw_only=kw_only)


__all__ = ["valueclass"]
