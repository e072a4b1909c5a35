"""The only code that touches the outside: clock, ports, loop."""
