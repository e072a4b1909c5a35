"""The device families that come with the program: a folder each, found by entry point."""
