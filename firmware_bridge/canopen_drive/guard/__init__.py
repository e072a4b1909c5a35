"""The guard's rules of CiA 402 drives; they share no code with the driver."""
