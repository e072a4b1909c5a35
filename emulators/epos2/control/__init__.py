"""CiA 402 device control: power states, errors and reactions, and motion control above the servo axis."""
