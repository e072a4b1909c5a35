"""The bridge between an operator and a robot's drives, with the protocols of both. It knows no simulation."""
