"""For tests of one's own: control of emulated devices that run in another process."""
