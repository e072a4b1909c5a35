"""MAVLink as its documents have it: frames, signatures, clocks, modes; no robot, and no one who drives."""
