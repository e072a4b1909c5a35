"""What may move: the snapshot, the interlocks, the gate and the guard."""
