"""The toy drive, a made-up motor controller on a serial line: a device family, and a trolley on one."""
