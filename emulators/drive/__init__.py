"""A drive of CiA 402 above a servo axis, of any product: the shaft under command, the modes that move it."""
