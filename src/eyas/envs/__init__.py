"""Interfaces of the simulation for reinforcement-learning libraries."""
