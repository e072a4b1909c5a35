"""The control port of emulated devices that run in real time: faults, inputs, restarts, at any instant."""
