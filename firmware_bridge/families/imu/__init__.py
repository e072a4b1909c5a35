"""An inertial measurement unit (IMU) on a serial line: accelerations and rates in, pitch and roll out."""
