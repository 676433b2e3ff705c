"""Pictures on a device: the renderer's kernels as stages, over many views at once."""
