"""The servo loops of the drives: what happens on every tick, away from the bus."""
