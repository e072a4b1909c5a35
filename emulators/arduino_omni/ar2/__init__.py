"""The board of the arm AR2: an Arduino Mega with step drivers, limit switches, servos, inputs and outputs."""
