"""The objects of a drive: their values, those that survive a restart, and what each type of drive has."""
