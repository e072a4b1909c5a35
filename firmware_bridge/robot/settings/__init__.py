"""A robot file's settings of each driver's links, axes, sensors and outputs; for bridge and emulators."""
