"""Optics: the pinhole camera, and lenses that bend its rays.

Begin with `pinhole.py`.
"""
