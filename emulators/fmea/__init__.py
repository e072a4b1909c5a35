"""What comes of every fault in every state of a robot: failure mode and effects analysis, on the bench."""
