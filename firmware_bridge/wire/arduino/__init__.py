"""What is said to Arduino boards over a serial line: a protocol a module, a table of typed rows each."""
