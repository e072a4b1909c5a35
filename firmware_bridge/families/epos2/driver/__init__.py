"""The bridge's side of an EPOS2, whatever link it is on: set-up, tasks, set-points, scale."""
