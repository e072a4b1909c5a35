"""The bench's half of each robot that comes with the program: missions and rehearsal, a folder each."""
