"""People and robots: their skeletons, shapes and motion. Begin with `figure.py`."""
