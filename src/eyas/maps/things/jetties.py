"""Jetties and rowing boats. Lengths in metres; z = 0 is the water, x leads out onto it."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.mesh.assembly import concatenate
from eyas.engine.mesh.flat import quads
from eyas.engine.mesh.panels import cells
from eyas.engine.mesh.solids import box
from eyas.engine.state.mesh import Material, Mesh
from eyas.engine.world.build.materials import material
from eyas.engine.world.build.scene_builder import Levels

LONG = 9.0  # Length of a jetty, of which a part is over land
BESIDE = 1.9  # From the middle of a jetty to that of a boat beside it

_WIDE, _DECK = 1.5, 0.42
_PLANKS = material("bark", (0.98, 0.90, 0.80))
_POSTS = material("bark", (0.66, 0.58, 0.50))
_HULLS = (
    material("plain", (0.86, 0.85, 0.80)),
    material("plain", (0.18, 0.34, 0.46)),
    material("plain", (0.50, 0.16, 0.12)),
)
_INSIDE = material("bark", (0.92, 0.80, 0.64))

_STATIONS = np.array([-1.7, -1.0, 0.0, 1.0, 1.55, 1.9])
_HALF = np.array([0.50, 0.64, 0.68, 0.54, 0.30, 0.02])
"""Half the width of a boat at its rim, from the stern to the bow."""
_RIM = np.array([0.40, 0.38, 0.37, 0.42, 0.49, 0.55])

Rows = NDArray[np.float64]


def jetty_levels() -> Levels:
    """Return a jetty of planks on posts, the finest level of detail first."""
    deck = box((LONG, _WIDE, 0.08), (LONG / 2 - 2.0, 0.0, _DECK), _PLANKS, 1.6)
    beams = [
        box((LONG, 0.12, 0.14), (LONG / 2 - 2.0, y, _DECK - 0.11), _POSTS, 2.0) for y in (-0.6, 0.6)
    ]
    posts = [
        box((0.16, 0.16, 1.3), (x, y, 0.2), _POSTS, 2.0)
        for x in (0.2, 3.4, 6.8)
        for y in (-_WIDE / 2 - 0.05, _WIDE / 2 + 0.05)
    ]
    # Gaps between planks are seen from above near by.
    gaps = [box((0.02, _WIDE, 0.03), (x, 0.0, _DECK + 0.04), _POSTS, 2.0) for x in _gaps()]
    return concatenate([deck, *beams, *posts, *gaps]), concatenate([deck, *posts]), deck


def _gaps() -> list[float]:
    count = int(LONG / 0.3)
    return [-2.0 + 0.3 * (k + 1) for k in range(count - 1)]


def boat_levels(
    look: int,  # Colour of its hull
) -> Levels:
    """Return a rowing boat with its bow at +x, the finest level of detail first."""
    hull = _HULLS[look % len(_HULLS)]
    benches = [box((0.22, 1.0, 0.04), (x, 0.0, 0.26), _INSIDE, 1.0) for x in (-0.9, 0.25)]
    oars = [box((2.1, 0.07, 0.05), (-0.2, y, 0.42), _INSIDE, 1.0) for y in (-0.36, 0.36)]
    rough = concatenate([_sides(1.0, hull), _sides(-1.0, _INSIDE)])
    return concatenate([rough, *benches, *oars]), rough


def _sides(outwards: float, cover: Material) -> Mesh:
    """Return the outside of a hull, or its inside where `outwards` is -1."""
    inner = 0.0 if outwards > 0.0 else 0.05
    rim = np.maximum(_HALF - inner, 0.01)
    keel = 0.62 * rim
    low = np.full(len(rim), 0.1 * (outwards < 0.0) - 0.05)
    top = _RIM - 0.02 * (outwards < 0.0)
    rows = [
        np.column_stack([_STATIONS, side * half, z])
        for side, half, z in ((-1, rim, top), (-1, keel, low), (1, keel, low), (1, rim, top))
    ]
    made = [cells([lower, upper]) for lower, upper in zip(rows[1:], rows[:-1], strict=True)]
    stern = np.array([[row[0] for row in (rows[0], rows[3], rows[2], rows[1])]])
    faces = np.concatenate([*made, stern])
    if outwards < 0.0:
        faces = faces[:, ::-1]
    return quads(faces, faces[..., :2], cover)
