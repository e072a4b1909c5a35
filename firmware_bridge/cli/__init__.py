"""The command line: its own commands, and those that other installed packages attach to it.

It refuses to know the simulation: the bridge runs without it.
"""

from firmware_bridge.cli.program import attach_commands, main, program

__all__ = ["attach_commands", "main", "program"]
