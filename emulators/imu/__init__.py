"""An emulated IMU: a cheap MEMS part on a body of the plant, and a processor that sends its frames."""
