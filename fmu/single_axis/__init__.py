"""One drive on a bench: motor, gear with backlash, a load between stops."""
