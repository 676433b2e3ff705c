"""Drones from flights: the constants that a log tells."""
