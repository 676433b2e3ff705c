"""The robots of the original, wheeled and legged."""
