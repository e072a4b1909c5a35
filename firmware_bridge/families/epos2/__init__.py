"""EPOS2 drives, on CAN or behind a serial port."""
