"""Roads: networks, areas, paint, wear, and the elevated road."""
