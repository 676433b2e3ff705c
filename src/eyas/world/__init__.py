"""The static world: roads, buildings, trees, the maps and the weather."""
