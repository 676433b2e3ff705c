"""The textures, which `art/textures` paints and ships as data (`shipped.py`)."""
