"""A drive of CiA 402 on CANopen as the bridge drives and guards it; a family adds what differs by product."""
