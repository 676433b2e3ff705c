"""The catalogue as a table."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from rich.table import Table

from eyas.engine.state.draw import DrawList
from eyas.engine.state.mesh import Mesh
from eyas.engine.state.motion import ActorState
from eyas.engine.targets.bird import BIRD
from eyas.engine.targets.catalogue import KINDS, MODELS, kind_index, models_of
from eyas.engine.targets.kind import Kind, Looks
from eyas.engine.targets.quadrotor import QUADROTOR
from eyas.engine.targets.rig import Rigs
from eyas.engine.targets.words import colour_words


@dataclass(frozen=True, slots=True)
class ModelRow:
    """A line of the table."""

    name: str
    kind: str
    size: tuple[float, float, float]  # Length, width and height [m]
    colours: tuple[str, ...]  # See `colour_words`
    motion: str
    mass: float | None  # [kg]; None: not known
    triangles: tuple[int, int]
    """Number of triangles at the finest and at the coarsest level of detail."""


def entries() -> list[ModelRow]:
    """Return a line for each model that can be a target, in the order of `MODELS`."""
    lines = []
    for kind in KINDS:
        if kind in (QUADROTOR, BIRD):  # which fly about; none can be followed
            continue
        levels = kind.rig().part_levels()
        for model in models_of(kind_index(kind.name)):
            parts = [levels[part] for part in _parts(kind, model)]
            lines.append(
                ModelRow(
                    name=MODELS[model].name,
                    kind=kind.name,
                    size=MODELS[model].size,
                    colours=colour_words(model),
                    motion=MODELS[model].motion,
                    mass=MODELS[model].mass,
                    triangles=(_triangles(parts, 0), _triangles(parts, -1)),
                )
            )
    return lines


def _parts(kind: Kind, model: int) -> list[int]:
    """Return the parts that a model is drawn with, as indices among those of its kind."""
    rigs, actors = Rigs(np.array([kind_index(kind.name)], np.int32)), ActorState.create(1, 1)
    actors.present[:] = True
    out: DrawList = rigs.draw_list(1)
    looks = Looks(np.full((1, 1), model, np.int32), np.ones((1, 1, 3), np.float32))
    rigs.pose(actors, looks, out)
    return [part for part in out.part[0].tolist() if part >= 0]


def _triangles(parts: Sequence[tuple[Mesh, ...]], level: int) -> int:
    return sum(len(part[level].triangles) for part in parts)


def table() -> Table:
    """Return the table for the terminal."""
    shown = Table("name", "kind", "size [m]", "mass [kg]", "motion", "triangles", "looks", box=None)
    for line in entries():
        size = " x ".join(f"{side:.2f}" for side in line.size)
        mass = "" if line.mass is None else f"{line.mass:.0f}"
        near, far = line.triangles
        colours = ", ".join(line.colours)
        shown.add_row(line.name, line.kind, size, mass, line.motion, f"{near} to {far}", colours)
    return shown
