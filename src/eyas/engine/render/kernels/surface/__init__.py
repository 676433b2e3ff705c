"""Shading of surfaces: texture, snow, water."""
