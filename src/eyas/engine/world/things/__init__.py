"""What stands on maps: the table of its kinds, and the structures that only one map has so far."""
