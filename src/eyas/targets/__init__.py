"""Targets: the catalogue of their kinds and models, with shapes and sizes."""
