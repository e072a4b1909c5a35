"""The bench: a mission driven in virtual time, and what is reported of it."""
