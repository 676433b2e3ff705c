"""Bounds on the numbers that enter a simulation or a picture: finite but absurd ones would become
indices, or never-ending loops, in kernels. Usual numbers cost one product, 0.7 µs.
"""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import EyasError

Floats = NDArray[np.float64]

LARGEST = 1e4  # Largest number of a command, as of the speeds of environments' actions
FARTHEST = 1e6  # Farthest place from the origin along each axis [m], as in recordings of traffic


def limited(values: Floats, most: float) -> Floats:
    """Return numbers from -`most` to `most`, and 0 for NaN."""
    if np.vdot(values, values) <= most * most:
        return values
    return np.clip(np.where(np.isnan(values), 0.0, values), -most, most)


def checked(
    values: Floats,  # Numbers, of any shape
    most: float,  # As above
    what: str,  # What they are, for the error
) -> Floats:
    """Return numbers from -`most` to `most`.

    Raises:
        EyasError: One is NaN or infinite.
    """
    if np.vdot(values, values) <= most * most:
        return values
    if not np.isfinite(values).all():
        shown = " ".join(np.array2string(np.asarray(values), threshold=12).split())
        raise EyasError(f"{what}: {shown} is not allowed; allowed: finite numbers")
    return np.clip(values, -most, most)
