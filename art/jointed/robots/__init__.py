"""The robots of the original, wheeled and legged: a file for each, which holds it as `MODEL`.

A new one needs its file and its name in `TargetName`.
"""

from importlib import import_module
from pkgutil import iter_modules

from art.jointed.model import JointedModel
from eyas.engine.targets.config import TargetName

__all__ = ["ROBOTS"]


def _read() -> tuple[JointedModel, ...]:
    files = [module.name for module in iter_modules(__path__)]
    models = [import_module(f"{__name__}.{file}").MODEL for file in files]
    order = [name.value for name in TargetName]
    return tuple(sorted(models, key=lambda model: order.index(model.name)))


ROBOTS: tuple[JointedModel, ...] = _read()  # All robots, in the order of `TargetName`
