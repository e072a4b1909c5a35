"""NatNet, by which OptiTrack's Motive streams what its cameras see: packets as data, a table for each."""
