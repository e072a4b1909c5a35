"""A plain servo drive of CiA 402 on CANopen, of no maker: objects, modes and reactions by the standard."""
