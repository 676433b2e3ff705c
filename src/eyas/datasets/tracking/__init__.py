"""Scoring box trackers on recordings and data sets."""
