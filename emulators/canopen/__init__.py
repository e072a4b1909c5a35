"""A CANopen device as the standards have it: CiA 301 and 305; no product is known here."""
