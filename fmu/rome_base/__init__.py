"""ROME's omni base: equations, parameters and reference trajectory of the three-wheeled platform."""
