"""The simulation at the command line: a file for each command."""
