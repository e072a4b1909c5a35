"""The bench's half of each robot that comes with the program: its missions and its rehearsal; a folder each."""
