"""Trains that stand on the elevated railway."""

from eyas.mesh.assembly import concatenate
from eyas.mesh.solids import box
from eyas.state.mesh import Mesh
from eyas.state.scene import ObjectClass
from eyas.world.build.materials import material
from eyas.world.build.scene_builder import SceneBuilder
from eyas.world.maps.downtown.viaduct import RAIL, Viaduct

__all__ = ["PITCH", "add_train"]

PITCH = 15.2
"""From one car of a train to the next [m]."""

_CAR = (14.6, 2.7, 3.3)
"""Length, width and height of a car [m]."""
_SILVER = material("plain", (0.72, 0.74, 0.76))
_ROOF = material("plain", (0.58, 0.60, 0.62))
_STRIPE = material("plain", (0.12, 0.24, 0.50))
_PANE = material("plain", (0.06, 0.08, 0.10))
_DARK = material("plain", (0.16, 0.19, 0.19))


def add_train(builder: SceneBuilder, line: Viaduct, first: float, cars: int, track: float) -> None:
    """Add a train of some cars; `first` is the middle of the first [m]."""
    kind = builder.prototype("railway car", lambda: (_car(fine=True), _car()))
    owner = None
    for k in range(cars):
        place = first + k * PITCH
        spot = (*line.at(place, track).tolist(), RAIL)
        owner = builder.add_copy(ObjectClass.STRUCTURE, kind, spot, line.turn, 1.0, owner)
    long, wide, high = _CAR
    ends = (first - long / 2, first + (cars - 1) * PITCH + long / 2)
    outline = line.strip(*ends, track - wide / 2, track + wide / 2)
    assert owner is not None  # there are cars
    builder.add_prism(outline, RAIL, RAIL + high + 0.35, owner)


def _car(*, fine: bool = False) -> Mesh:
    """Return a car of a train along x, on rails at z = 0."""
    long, wide, high = _CAR
    low = 0.85
    made = [
        box((long, wide, high - low - 0.25), (0.0, 0.0, (low + high - 0.25) / 2), _SILVER, 1.0),
        box((long - 0.3, wide - 0.5, 0.3), (0.0, 0.0, high - 0.1), _ROOF, 1.0),
        box((long - 3.0, wide - 0.6, low), (0.0, 0.0, low / 2), _DARK, 1.0),
        box((long + 0.02, wide + 0.02, 0.22), (0.0, 0.0, low + 0.35), _STRIPE, 1.0),
        box((long - 1.2, wide + 0.03, 0.85), (0.0, 0.0, low + 1.25), _PANE, 1.0),
        box((long + 0.04, wide - 0.7, 0.9), (0.0, 0.0, low + 1.3), _PANE, 1.0),
        box((2.6, 1.3, 0.3), (-0.27 * long, 0.0, high + 0.18), _ROOF, 1.0),
        box((2.6, 1.3, 0.3), (0.27 * long, 0.0, high + 0.18), _ROOF, 1.0),
    ]
    if fine:
        made += [
            box((1.25, wide + 0.05, 1.95), (x, 0.0, low + 1.0), _SILVER, 1.0)
            for x in (-0.36 * long, -0.12 * long, 0.12 * long, 0.36 * long)
        ]
        made += [
            box((0.45, wide + 0.07, 0.8), (x + lean, 0.0, low + 1.25), _PANE, 1.0)
            for x in (-0.36 * long, -0.12 * long, 0.12 * long, 0.36 * long)
            for lean in (-0.3, 0.3)
        ]
    return concatenate(made)
