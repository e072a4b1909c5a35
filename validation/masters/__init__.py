"""How masters in the field start a drive of CiA 402, played against the emulated servo and its variations."""
