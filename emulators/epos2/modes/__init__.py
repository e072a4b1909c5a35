"""Modes of operation: the shaft's motion once the drive is enabled; one module for each kind of mode.

`table` lists the modes, `mode` has their base class, `motion` gives one of them the shaft. Source: EPOS
Firmware Specification, chapters of the modes (by analogy).
"""
