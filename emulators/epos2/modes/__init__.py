"""What the shaft does in each mode of operation, once the drive is enabled: one module for each kind of mode.

`table` says which modes there are, `mode` what a mode is, `motion` gives one of them the shaft. Source: EPOS
Firmware Specification, chapters of the modes (by analogy).
"""
