"""Painters of the textures, each by formula. Begin with `library.py`."""
