"""Data only: dataclasses of arrays that the rooms hand to each other."""
