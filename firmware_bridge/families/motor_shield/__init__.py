"""Boards with a motor shield."""
