"""Scenes of plans, for the engine."""

from eyas.engine.state.roads import RoadNetwork
from eyas.engine.state.scene import Scene
from eyas.engine.world.weather import Season
from eyas.maps.plan.build import build_scene
from eyas.maps.plan.file import plan_of, text_of
from eyas.maps.plan.plan import MapPlan
from eyas.maps.towns.completed import completed

__all__ = ["PLANNER"]


class _Planner:
    """See `eyas.engine.world.maps.planner.Planner`."""

    def complete(self, plan: MapPlan, network: RoadNetwork) -> MapPlan:
        return completed(plan, network)

    def text_of(self, plan: MapPlan) -> str:
        return text_of(plan)

    def build(self, text: bytes, network: RoadNetwork, season: Season) -> Scene:
        return build_scene(plan_of(text), network, season)


PLANNER = _Planner()
