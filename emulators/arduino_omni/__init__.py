"""An Arduino Mega 2560 with an Adafruit Motor Shield V2, as in ROME's base, emulated to the register."""
