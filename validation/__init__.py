"""Proof of the product, not part of it: studies of the sources, reference solutions, makers of pages.

It comes with a checkout; `make setup` installs it beside the program.
"""
