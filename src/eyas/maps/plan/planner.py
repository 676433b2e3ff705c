"""Scenes of plans, for the engine.

Light: a start that finds a scene in the cache asks only what the code of its makers is.
"""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from eyas.engine.state.roads import RoadNetwork
    from eyas.engine.state.scene import Scene
    from eyas.engine.world.weather import Season
    from eyas.maps.plan.plan import MapPlan


class _Planner:
    """Planner of the plans in `eyas.maps.plan`, see `eyas.engine.world.maps.planner.Planner`."""

    def complete(self, plan: "MapPlan", network: "RoadNetwork") -> "MapPlan":
        from eyas.maps.towns.completed import completed

        return completed(plan, network)

    def text_of(self, plan: "MapPlan") -> str:
        from eyas.maps.plan.file import text_of

        return text_of(plan)

    def build(self, text: bytes, network: "RoadNetwork", season: "Season") -> "Scene":
        from eyas.maps.plan.build import build_scene
        from eyas.maps.plan.file import plan_of

        return build_scene(plan_of(text), network, season)


PLANNER = _Planner()
