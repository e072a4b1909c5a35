"""The bridge's half of each robot that comes with the program: a folder each; they do not know each other."""
