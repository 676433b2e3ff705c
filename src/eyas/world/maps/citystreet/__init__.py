"""The map citystreet."""
