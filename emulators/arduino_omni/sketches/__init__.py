"""Firmwares for the board, one module each; the wire is in `firmware_bridge.families.motor_shield.wire`."""
