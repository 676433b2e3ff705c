"""Recordings and data sets, read, and exported in the formats of other tools.

May import: `policies` and all rooms below. The formats are in the house `datasets`.
Begin with `recording.py`, then `format.py`, `export.py`.
"""
