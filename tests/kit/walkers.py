"""Targets that walk, as few as most tests need."""

FEW = {"max_count": 4, "interval": 10.0, "group_size": 4}
"""Settings `objects`: four, of which each stays. With short episodes the defaults are thousands of
lives, whose ways take seconds to make."""
