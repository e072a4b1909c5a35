"""The board: its processor's own traits, its serial port and its pins, and the libraries that sketches call."""
