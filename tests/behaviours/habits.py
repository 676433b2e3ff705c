"""How each kind moves by itself, from the catalogue."""

from eyas.targets.catalogue import KINDS

HABITS = {kind.name: kind.habit for kind in KINDS if kind.habit is not None}
