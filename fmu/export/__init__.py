"""Export of equations as an FMU: C code, model description, shell, archive."""
