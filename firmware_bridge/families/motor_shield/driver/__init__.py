"""The bridge's side of an Arduino with a motor shield: four protocols, one board."""
