"""The maps, one recipe a file."""
