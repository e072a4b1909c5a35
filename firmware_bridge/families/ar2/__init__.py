"""Boards of AR2 arms."""
