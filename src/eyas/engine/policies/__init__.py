"""Policies: what a class answers to fly trackers, what it is given, and helpers to steer.

May import: `envs` and all rooms below. The built-in policies are in the house `benchmark`.
Begin with `policy.py`, then `steering.py`.
"""
