"""Driver of a CiA 402 drive: process data in every cycle, objects over SDO, tasks and stop stages."""
