"""An Arduino Mega 2560 with an Adafruit Motor Shield V2, emulated to the register."""
