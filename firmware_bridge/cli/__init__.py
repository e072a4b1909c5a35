"""The command line: its own commands, and those that other installed packages add to it.

The simulation is not known here: the bridge runs without it.
"""

from firmware_bridge.cli.program import main, program

__all__ = ["main", "program"]
