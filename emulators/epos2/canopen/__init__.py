"""The CANopen side of a drive: network state, identifiers, services, PDOs, error control, layer setting."""
