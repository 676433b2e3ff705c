"""Places from which smoke rises."""

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import stream
from eyas.engine.state.scene import ObjectClass, Scene

_HIGHEST = 45.0  # Buildings that are higher have no chimney [m]


def chimneys(scene: Scene, count: int) -> NDArray[np.float32]:
    """Return so many places on roofs [m] and how bright their smoke is, shape (S, 4).

    On a map without buildings, something burns on the ground.
    """
    if count == 0:
        return np.zeros((0, 4), np.float32)
    rng, solid = stream(scene.seed, "smoke"), scene.colliders
    built = scene.object_class[solid.prism_object] == ObjectClass.BUILDING
    roofs = np.flatnonzero(built & (solid.prism_top < _HIGHEST))
    grey = rng.uniform(0.3, 0.8, count)
    if len(roofs) == 0:
        place = rng.uniform(-0.3, 0.3, (count, 2)) * scene.size
        ground = np.full(count, scene.terrain.floor)
        return np.column_stack([place, ground, grey]).astype(np.float32)
    chosen = rng.choice(roofs, count, replace=len(roofs) < count)
    first = solid.prism_first
    middle = [solid.prism_points[first[k] : first[k + 1]].mean(axis=0) for k in chosen.tolist()]
    return np.column_stack([np.array(middle), solid.prism_top[chosen], grey]).astype(np.float32)
