"""The board: its processor's own traits, its serial port, its pins, and the libraries that sketches call."""
