"""Drives of CiA 402 on a CAN bus, of any maker: what they do alike by the standards."""
