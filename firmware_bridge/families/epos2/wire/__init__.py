"""The EPOS2 as tables: objects, emergencies, states and units of one drive family."""
