"""The simulation at the command line: what a command asks for, and in `*_work` what it does, imported last."""
