"""The operator's side: a ground station as a node, and who may drive at it: a hand, or a path follower."""
