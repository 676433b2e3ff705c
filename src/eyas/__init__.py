"""Eyas: a simulator and benchmark for drone visual active tracking.

Importing it makes its environments known to Gymnasium.
"""

from eyas.envs.registration import register as _register

__all__ = ["__version__"]

__version__ = "0.1.0"

_register()
