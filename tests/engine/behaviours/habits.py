"""How each object of the original moves by itself, on the ground, from the catalogue."""

from eyas.engine.targets.catalogue import KINDS
from eyas.engine.targets.config import TargetName

HABITS = {
    kind.name: kind.habit
    for kind in KINDS
    if kind.habit and kind.name in [*TargetName] and not kind.flies
}
