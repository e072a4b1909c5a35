"""Common parts of the plants: motors, dry friction, stops, the table that a run is written to."""
