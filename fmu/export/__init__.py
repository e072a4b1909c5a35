"""From equations to an FMU: C code, model description, shell, archive."""
