"""Arrays baked once for a map and its light: shadows, ambient light, tracks, clouds, hills."""
