"""Serial protocols of Arduino boards: one module each, with a table of typed rows."""
