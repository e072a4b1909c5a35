"""maxon's serial protocols, both ends: V1 on RS232, V2 on USB. It refuses to know ports and clocks."""
