"""CANopen as its standards have it: no product is known here."""
