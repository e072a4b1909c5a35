"""The EPOS2's modes of operation: its own, and its differences from those of CiA 402 in `emulators.drive`.

`table` lists them. Source: EPOS Firmware Specification, chapters of the modes (by analogy).
"""
