"""Buildings: lots, heights, facades, roofs."""
