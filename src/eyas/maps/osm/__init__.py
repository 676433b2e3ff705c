"""OpenStreetMap: reading its files, and what of them a map is made of."""
