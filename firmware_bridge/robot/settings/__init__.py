"""What a robot file says of each driver's links, axes, sensors and outputs; read by bridge and emulators."""
