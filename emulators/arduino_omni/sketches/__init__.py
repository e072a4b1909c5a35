"""Firmwares for the board, one module each; what is on the wire stands in `firmware_bridge.wire.arduino`."""
