"""Policies, protocols and figures: the same episodes for all, with their uncertainty.

May import: `engine`, `lanes`.
Begin with `README.md`, then `plan/plan.py` and `flight/batch_flight.py`.
"""
