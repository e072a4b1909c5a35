"""Emulated devices, the virtual world that carries their packets, and the bench that drives a robot."""
