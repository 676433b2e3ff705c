"""Marks over finished pictures: what a camera sees, what is rewarded, where the target is."""
