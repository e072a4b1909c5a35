"""EPOS2 drives at the command line: emulated alone or for a robot, documents, a new robot of them."""
