"""How each object of the original moves by itself, from the catalogue."""

from eyas.targets.catalogue import KINDS
from eyas.targets.config import TargetName

HABITS = {kind.name: kind.habit for kind in KINDS if kind.habit and kind.name in [*TargetName]}
