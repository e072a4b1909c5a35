"""The guard of EPOS2 drives: what may be written to them, and what is put in the place of the rest."""
