"""Recordings of CAN buses and serial lines explained: incidents with causes and recovery, and numbers."""
