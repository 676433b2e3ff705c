"""The renderer of many small pictures: textures, baking, culling, rasterising, shading.

May import: `world` and all rooms below.
Begin with `renderer.py`, then `kernels/draw.py`. Private: `eyas` offers what is public.
"""
