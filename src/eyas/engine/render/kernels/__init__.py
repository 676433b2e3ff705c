"""The inner loops of the renderer: culling, rasterising, shading."""
