"""The simulation at the command line: what a command asks for; `*_work`, imported last, is what it does."""
