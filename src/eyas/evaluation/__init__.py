"""Evaluation of policies: the same episodes for all, and figures with their uncertainty."""
