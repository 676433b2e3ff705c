"""Textures, painted by formula."""
