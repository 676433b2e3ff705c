"""The textures: painted by formula (`library.py`), and shipped as data (`shipped.py`)."""
