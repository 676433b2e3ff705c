"""Tools that every map is built with: the scene builder, simple shapes, materials."""
