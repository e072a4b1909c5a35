"""EPOS2 drives on a CAN bus: process data in every cycle, objects over SDO."""
