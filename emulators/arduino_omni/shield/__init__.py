"""The motor shield: its I2C bus, its PWM chip to the register, and what its half bridges make of it."""
