"""The bench's half of each robot that comes with the program: missions and bench setup, a folder each."""
