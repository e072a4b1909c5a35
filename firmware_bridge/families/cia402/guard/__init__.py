"""The guard's rules of CiA 402 drives of any maker."""
