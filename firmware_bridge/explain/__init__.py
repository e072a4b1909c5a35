"""Recordings of a CAN bus explained: incidents with causes and recovery, drives that do not move, numbers."""
