"""The small-image renderer: textures, baking, culling, rasterising, shading."""
