"""Eyas: a simulator and benchmark for drone visual active tracking."""

__all__ = ["__version__"]

__version__ = "0.1.0"
