"""One drive in an engineer's hands: objects and states over CAN or a serial line, one job at a time."""
