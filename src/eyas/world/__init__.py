"""What does not move: roads, buildings, trees, the maps and the weather."""
