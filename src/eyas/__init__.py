"""Eyas: a simulator and benchmark for drone visual active tracking.

Importing it makes its environments known to Gymnasium.
"""

from eyas.envs.registration import register as _register

__all__ = ["__version__", "build_id"]

__version__ = "0.1.0"

build_id: str
"""Identifies code and data of this Eyas, see `eyas.core.build`: results of the same build, settings
and seed are the same to the bit."""

_register()


def __getattr__(name: str) -> str:
    if name == "build_id":  # reads all files of the package, so only when it is asked for
        from eyas.core.build import this_build

        return this_build().id
    raise AttributeError(f"module 'eyas' has no attribute {name!r}")
