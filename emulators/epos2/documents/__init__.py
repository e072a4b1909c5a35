"""Documents of the emulated EPOS2: its objects, EDS and DCF, and the provenance of all of it."""
