"""Measuring how fast this machine runs Eyas."""
