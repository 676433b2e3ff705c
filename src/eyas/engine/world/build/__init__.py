"""Tools that every map is built with: the scene builder, heights, materials."""
