"""The drive's serial port: commands onto its own objects, and through it to the drives on its CAN bus."""
