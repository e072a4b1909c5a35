"""Emulated boards at the command line."""
