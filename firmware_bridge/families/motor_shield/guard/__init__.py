"""The guard of boards with a motor shield: which commands may leave, and what takes the place of others."""
