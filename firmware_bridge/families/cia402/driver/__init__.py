"""Driver of a CiA 402 drive of any maker."""
