"""The catalogue: all kinds of targets and all their models.

Vehicles, people and robots ship as data: `art/catalogue.py` makes them, of one file for each
(`art/vehicles/models`, `art/jointed/robots`). A new kind is a file with its models and its rig, and
one call of `register`.
"""

from dataclasses import fields
from functools import cache, partial

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.errors import ConfigError
from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.bird import BIRD
from eyas.engine.targets.habit import Habit
from eyas.engine.targets.jointed.rig import JointedRig, extent_at
from eyas.engine.targets.kind import Kind, KindFacts, Model, Section
from eyas.engine.targets.quadrotor import QUADROTOR
from eyas.engine.targets.shapes import ShapeEntry, read_index
from eyas.engine.targets.vehicles.rig import VehicleRig
from eyas.lanes.elementary.arrays import cos

Floats = NDArray[np.float64]

KINDS: list[Kind] = []  # All kinds. In the other rooms, `kind` is the index into this table.

MODELS: list[Model] = []
"""All models, kind by kind. In the other rooms, `model` is the index into this table."""


def register(kind: Kind) -> None:
    """Add a kind and its models; existing ones keep their indices.

    Raises:
        ConfigError: A name is taken, a model belongs to another kind, or something is missing.
    """
    taken = {known.name for known in KINDS} & {kind.name}
    names = [known.name for known in (*MODELS, *kind.models)]
    taken |= {model.name for model in kind.models if names.count(model.name) > 1}
    if taken:
        raise ConfigError(f"targets: {sorted(taken)} are in the catalogue already")
    strangers = [model.name for model in kind.models if model.kind != kind.name]
    if strangers or not kind.models:
        raise ConfigError(f"targets: {kind.name!r} needs models of its own, not {strangers}")
    for model in kind.models:
        model.check()
    KINDS.append(kind)
    MODELS.extend(kind.models)


def kind_index(name: str) -> int:
    """Return the index of a kind in `KINDS`."""
    return next(i for i, kind in enumerate(KINDS) if kind.name == name)


def habit_of(kind: str) -> Habit:
    """Return how a kind moves by itself, given by its name: a person or a robot."""
    habit = KINDS[kind_index(kind)].habit
    assert habit is not None
    return habit


@cache
def kind_of(model: int) -> Kind:
    """Return the kind of a model, given by its index in `MODELS`."""
    return KINDS[kind_index(MODELS[model].kind)]


def model_index(name: str) -> int:
    """Return the index of a model in `MODELS`."""
    return next(i for i, model in enumerate(MODELS) if model.name == name)


def models_of(kind: int) -> range:
    """Return the models of a kind, given by its index in `KINDS`, as indices into `MODELS`."""
    first = model_index(KINDS[kind].models[0].name)
    return range(first, first + len(KINDS[kind].models))


def extent_of(
    model: int,  # Index in `MODELS`
    travelled: float,  # Horizontal way since it entered the world [m]
    speed: float,  # [m/s]
    slope: float,  # Pitch of the ground along its heading [rad]
) -> Floats | None:
    """Return the box of a model at a moment, see `Kind.extent`; None if it is that of its size."""
    kind = kind_of(model)
    if kind.extent is None:
        return None
    upright = kind.object_class is ObjectClass.PERSON
    return kind.extent(MODELS[model].name, travelled / (1.0 if upright else cos(slope)), speed)


def sections_of(model: int) -> tuple[Section, ...]:
    """Return the sections of an articulated model, given by its index in `MODELS`; none of others,
    which are rigid.
    """
    kind = kind_of(model)
    return kind.sections[kind.models.index(MODELS[model])] if kind.sections else ()


def _shipped(entry: ShapeEntry) -> Kind:
    facts = {field.name: getattr(entry.facts, field.name) for field in fields(KindFacts)}
    rig, extents = VehicleRig if entry.drives else JointedRig, entry.shapes.extents
    extent = None if extents is None else partial(extent_at, extents)
    return Kind(**facts, rig=partial(rig, entry.shapes), extent=extent)


_ENTRIES = read_index().kinds

VEHICLE_KINDS = tuple(_shipped(entry) for entry in _ENTRIES if entry.drives)
"""All kinds of vehicles, in the order of `VehicleType`."""

*_WALKERS, _CYCLIST = (_shipped(entry) for entry in _ENTRIES if not entry.drives)

for _kind in (*VEHICLE_KINDS, QUADROTOR, *_WALKERS, BIRD, _CYCLIST):
    register(_kind)
