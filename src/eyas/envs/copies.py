"""Copies of environments: what they need not hold, since a process has it or makes it anew."""

import types
from enum import Enum
from functools import partial

import gymnasium
from pydantic import BaseModel

from eyas.lanes import BoundCall, CompiledCall, Held
from eyas.render.renderer import CpuRenderer
from eyas.sim.assets import Assets
from eyas.sim.episode_draw import DrawRules, ModelTable
from eyas.sim.light import LightRules
from eyas.sim.views.visible_actors import VisibleActors
from eyas.state.draw import Picture
from eyas.state.lighting import Lighting
from eyas.state.motion import Motion
from eyas.state.terrain import Terrain
from eyas.targets.looks import LookTable
from eyas.task.journal import Journal

__all__ = ["FIXED"]

_CODE = (types.FunctionType, types.MethodType, partial, type, CompiledCall)
_SETTINGS = (BaseModel, Enum, gymnasium.Space)
_SHARED = (Assets, CpuRenderer, Lighting, Motion, Terrain)
_TABLES = (DrawRules, LightRules, LookTable, ModelTable)
"""Made of the settings and the catalogue, which may have grown in this process."""
_BOUND = (BoundCall, Held)
"""To the addresses of arrays, which stay."""
_SCRATCH = (VisibleActors, Picture)
"""Worked out at each use."""

FIXED = (*_CODE, *_SETTINGS, *_SHARED, *_TABLES, *_BOUND, *_SCRATCH, Journal)
"""Types of parts for `eyas.core.memento.remember` to leave out."""
