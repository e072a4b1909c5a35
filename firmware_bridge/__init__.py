"""The bridge between an operator and a robot's drives, and the words it speaks. Knows no simulation."""
