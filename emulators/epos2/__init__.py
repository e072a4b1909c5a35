"""An emulated maxon EPOS2: protocol servers onto one object store, above a servo axis."""
