"""Tests of a user's own: a robot on the bench as a fixture of pytest."""
