"""An IMU as a source: frames judged, turned into the robot's axes, fused to pitch and roll, and reported."""
