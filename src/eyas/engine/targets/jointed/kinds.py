"""The kinds of people and robots."""

from functools import cache

import numpy as np
from numpy.typing import NDArray

from eyas.engine.state.scene import ObjectClass
from eyas.engine.targets.jointed.extent import Extents, extents_of
from eyas.engine.targets.jointed.model import JointedModel
from eyas.engine.targets.jointed.people.people import PEDESTRIANS
from eyas.engine.targets.jointed.riders.cyclist import CYCLISTS
from eyas.engine.targets.jointed.rig import JointedRig, layout_of
from eyas.engine.targets.jointed.robots import ROBOTS
from eyas.engine.targets.kind import Kind


def _kind(models: tuple[JointedModel, ...], object_class: ObjectClass) -> Kind:
    figures = {model.name: model.figure for model in models}

    @cache  # by name: to hash a figure takes longer than all the rest
    def extents(name: str) -> Extents:
        return extents_of(figures[name])

    def extent(name: str, travelled: float, speed: float) -> NDArray[np.float64]:
        return extents(name).at(travelled, speed)

    layout = cache(lambda: layout_of(models))
    return Kind(
        name=models[0].kind,
        models=models,
        colours=models[0].colours,
        object_class=object_class,
        rig=lambda: JointedRig(models, layout()),
        extent=extent,
        keeps_colours=True,
        habit=models[0].habit,
    )


JOINTED_KINDS: tuple[Kind, ...] = (
    _kind(PEDESTRIANS, ObjectClass.PERSON),
    *(_kind((model,), ObjectClass.ROBOT) for model in ROBOTS),
)
"""The pedestrian, then the robots in the order of `TargetName`."""

CYCLIST = _kind(CYCLISTS, ObjectClass.BICYCLE)
"""The cyclist, who is nobody's target in the original and so no `TargetName`."""
