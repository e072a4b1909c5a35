"""Objects and error codes of CiA 402 drives, for bridge and emulation alike."""
