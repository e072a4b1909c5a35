"""The protocols on the wires, as tables and small codecs. Standard library only; no time, no I/O."""
