"""The operator's side: MAVLink bytes to intent, snapshot to telemetry."""
