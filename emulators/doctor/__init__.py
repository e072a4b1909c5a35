"""Whether this machine has what the program needs: its facts, and a row for each."""
