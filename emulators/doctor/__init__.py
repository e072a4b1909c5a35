"""Check of this machine for the program's needs: its facts, and a row for each."""
