"""Faces of the simulation for reinforcement-learning libraries."""
