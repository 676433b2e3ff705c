"""Sun, shadows, ambient light, lamps, and the tone curve."""
