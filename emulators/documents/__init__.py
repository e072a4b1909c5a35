"""What the emulated EPOS2 can say of itself: its objects, EDS and DCF, and how far all of it is known."""
