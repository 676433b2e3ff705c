"""The cache on disk, kept from run to run in one folder with one limit of size.

Begin with `cached.py`, then `entries.py`, `array_file.py`.
"""
