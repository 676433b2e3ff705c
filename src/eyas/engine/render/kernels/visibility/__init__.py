"""From triangles to the visibility buffer: culling, transforming, rasterising."""
