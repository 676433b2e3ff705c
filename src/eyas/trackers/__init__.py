"""Trackers: the drone and its gimbal."""
