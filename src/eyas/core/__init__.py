"""Foundations of all rooms: errors, names, settings, random streams, clock, frames, compilation."""
