"""Optics: the pinhole camera and the lenses that bend its rays."""
