"""Robots with two driven wheels on one axle: what all of them have in common, for packages to build on."""
