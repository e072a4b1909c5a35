"""Kinematics, ramps and odometry: numbers in, numbers out."""
