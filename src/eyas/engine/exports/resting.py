"""Meshes of the models of the catalogue as they stand, for files of other programs."""

from dataclasses import replace
from functools import lru_cache

import numpy as np

from eyas.engine.mesh.assembly import concatenate, transformed
from eyas.engine.sim.scenes import load_parts
from eyas.engine.state.mesh import Material, Mesh, Surface
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.catalogue import MODELS, kind_index, model_index
from eyas.engine.targets.kind import Looks
from eyas.engine.targets.rig import Rigs


@lru_cache(maxsize=64)
def resting_mesh(
    model: str,  # Its name
    detail: int,  # Level of detail; 0 is the finest
) -> Mesh:
    """Return a model as one mesh, standing still, white where it is painted.

    x is forward, y left, z up; the origin is its reference point on the ground.
    """
    index = model_index(model)
    kind = kind_index(MODELS[index].kind)
    rigs, actors = Rigs(np.array([kind], np.int32)), ActorState.create(1, 1)
    actors.present[:] = True
    drawn = rigs.draw_list(1)
    looks = Looks(np.array([[index]], np.int32), np.ones((1, 1, 3), np.float32))
    rigs.pose(actors, looks, drawn)
    parts = load_parts((kind,)).parts
    slots = np.flatnonzero(drawn.part[0] >= 0)
    return concatenate(
        [
            transformed(parts[part][min(detail, len(parts[part]) - 1)], pose)
            for part, pose in zip(drawn.part[0, slots].tolist(), drawn.pose[0, slots], strict=True)
        ]
    )


def painted(mesh: Mesh, colour: tuple[float, ...]) -> Mesh:
    """Return a mesh in the colour of an instance, sRGB."""
    palette = tuple(_painted(material, colour) for material in mesh.palette)
    return replace(mesh, palette=palette)


def _painted(material: Material, colour: tuple[float, ...]) -> Material:
    if material.surface is not Surface.PAINT:
        return material
    red, green, blue = (a * b for a, b in zip(material.tint, colour, strict=True))
    return replace(material, tint=(red, green, blue))
