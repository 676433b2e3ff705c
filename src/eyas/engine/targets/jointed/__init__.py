"""Targets of jointed parts: people and robots."""
