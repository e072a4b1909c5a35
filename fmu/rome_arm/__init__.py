"""ROME whole: the arm AR2 on the base on three omni wheels."""
