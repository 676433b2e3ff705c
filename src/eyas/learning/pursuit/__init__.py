"""Self-play of a tracker and a target that wants to be lost; begins in `training.py`."""
