"""What may be followed: the catalogue of vehicles, their shapes and sizes."""
