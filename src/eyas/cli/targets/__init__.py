"""The catalogue of targets: a list, and pictures of each."""
