"""What the plants have in common: motors, dry friction, stops, the table that a run is written to."""
