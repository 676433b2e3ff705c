"""Data only: records of arrays that the rooms pass to each other."""
