"""maxon's serial protocols, both ends: V1 on RS232, V2 on USB. Ports and clocks are not known here."""
