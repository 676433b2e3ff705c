"""Recordings and data sets: read, exported in the formats of other tools, planned, described."""
