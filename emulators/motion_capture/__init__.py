"""An emulated motion capture system: a room with cameras, and Motive's stream of what they see."""
