"""Heights of the buildings, spread as in the original's downtown, and their looks."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.mesh import Material
from eyas.engine.world.build.materials import material
from eyas.lanes import exact
from eyas.maps.buildings.looks import Tint, wall_tint
from eyas.maps.downtown.lots import Lot
from eyas.maps.downtown.massing import STOREY

__all__ = ["cores", "facade_of", "roof_of", "storeys"]

_HEIGHT = ((0.0, 6.0), (0.25, 19.0), (0.5, 28.0), (0.75, 58.0), (0.88, 105.0), (0.95, 190.0), (0.985, 290.0), (1.0, 436.0))  # noqa: E501  # fmt: skip
"""Share of the buildings and height [m]: quantiles of the original's downtown."""
_CORES = ((-60.0, -40.0, 190.0), (290.0, 90.0, 150.0))
"""Where towers stand: u, v and reach of each quarter [m]."""
_SLENDER = 12.0  # Greatest height as a multiple of the shorter side of the lot

_OLD = (("facade_brick", 0.38), ("facade_stone", 0.18), ("facade_concrete", 0.12),
        ("facade_red_white", 0.09), ("facade_old", 0.10), ("facade_plaster", 0.13))  # fmt: skip
_MIDDLE = (("facade_brick", 0.20), ("facade_stone", 0.22), ("facade_concrete", 0.22),
           ("facade_office", 0.14), ("facade_highrise", 0.12), ("facade_bands", 0.05),
           ("facade_glass", 0.05))  # fmt: skip
_TALL = (("facade_glass", 0.36), ("facade_highrise", 0.20), ("facade_stone", 0.14),
         ("facade_office", 0.16), ("facade_concrete", 0.14))  # fmt: skip
"""Facades and their shares for low, middle and high buildings."""

_PANES: tuple[Tint, ...] = (
    (1.0, 1.0, 1.0),
    (0.80, 0.92, 1.0),
    (0.74, 0.90, 0.84),
    (0.52, 0.55, 0.60),
    (1.0, 0.88, 0.72),
)
"""Tints of glass towers: clear, blue, green, black, bronze."""

_ROOFS: tuple[tuple[float, str, Tint], ...] = (
    (0.30, "bitumen", (0.97, 0.97, 0.97)),
    (0.12, "roof_gravel", (0.92, 0.91, 0.90)),
    (0.11, "roof_membrane", (0.88, 0.89, 0.90)),
    (0.27, "roof_terrace", (1.0, 0.96, 0.94)),
    (0.20, "roof_terrace", (0.86, 0.84, 0.84)),
)
"""Share, texture and tint: a little more than half are grey, the others orange."""


def cores(places: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return how much places (u, v) belong to a quarter of towers, 0 to 1, shape (K,)."""
    near = [
        exact.exp(-(np.square(places[:, 0] - u) + np.square(places[:, 1] - v)) / np.square(reach))
        for u, v, reach in _CORES
    ]
    # Exponentials differ from processor to processor in their last bits.
    return np.asarray(np.round(np.max(near, axis=0), 6), np.float64)


def storeys(lots: Sequence[Lot], rng: np.random.Generator) -> NDArray[np.int64]:
    """Return the number of storeys of the building on each lot, shape (K,)."""
    share, value = np.array(_HEIGHT).T
    at = (np.arange(len(lots)) + rng.uniform(0.2, 0.8, len(lots))) / max(len(lots), 1)
    heights = np.round(exact.exp(np.interp(at, share, exact.log(value))), 3)
    core = cores(np.array([lot.centre for lot in lots]))
    area = np.array([lot.area for lot in lots])
    wide = np.round(np.sqrt(np.minimum(area, 2400.0)) / 49.0, 6)
    ticket = wide + 0.45 * core + rng.uniform(0.0, 0.42, len(lots))
    made = np.empty(len(lots))
    made[np.argsort(ticket, kind="stable")] = heights
    slim = np.array([min(lot.box[2] - lot.box[0], lot.box[3] - lot.box[1]) for lot in lots])
    made = np.minimum(made, _SLENDER * slim)
    return np.maximum(np.round(made / STOREY), 2).astype(np.int64)


def facade_of(height: float, rng: np.random.Generator) -> tuple[str, Tint]:
    """Return the facade of a building and the factor on its colour.

    Args:
        height: Height of the building [m].
        rng: Random numbers of the buildings.
    """
    table = _OLD if height < 36.0 else _MIDDLE if height < 110.0 else _TALL
    shares = np.array([odds for _, odds in table])
    kind = table[int(rng.choice(len(table), p=shares / shares.sum()))][0]
    if kind in ("facade_glass", "facade_office") and rng.random() < 0.75:
        return kind, _PANES[int(rng.integers(len(_PANES)))]
    return kind, wall_tint(rng)


def roof_of(rng: np.random.Generator) -> Material:
    """Return the cover of a building's flat roofs."""
    shares = np.array([share for share, _, _ in _ROOFS])
    _, name, (red, green, blue) = _ROOFS[int(rng.choice(len(_ROOFS), p=shares / shares.sum()))]
    age = float(rng.uniform(0.86, 1.0))
    return material(name, (red * age, green * age, blue * age))
