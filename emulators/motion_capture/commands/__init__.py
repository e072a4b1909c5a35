"""Emulated motion capture systems at the command line."""
