"""The maker of scenes from the plans of maps: a house of makers has a `Planner` at its door.

The engine knows plans as texts and as objects that it hands on; what is in them, the makers know.
"""

from functools import cache
from typing import TYPE_CHECKING, Any, Protocol

from eyas.engine.core.doors import first_brought
from eyas.engine.core.errors import ConfigError

if TYPE_CHECKING:  # maps load with `eyas`; the scene modules only when a scene is built
    from eyas.engine.state.roads import RoadNetwork
    from eyas.engine.state.scene import Scene
    from eyas.engine.world.weather import Season


class Planner(Protocol):
    """Makes scenes of plans."""

    def complete(self, plan: Any, network: "RoadNetwork") -> Any:  # noqa: ANN401  # a plan
        """Return a plan with all that it leaves open decided."""
        ...

    def text_of(self, plan: Any) -> str:  # noqa: ANN401  # a plan
        """Return a plan as JSON; equal plans give equal texts."""
        ...

    def build(self, text: bytes, network: "RoadNetwork", season: "Season") -> "Scene":
        """Return the scene of a plan that `text_of` has returned, UTF-8."""
        ...


@cache
def planner() -> Planner:
    """Return what makes scenes.

    Raises:
        ConfigError: No house here does.
    """
    found: Planner | None = first_brought("eyas.planner")
    if found is None:
        raise ConfigError("world.map: no house here makes scenes of plans (eyas.maps is not there)")
    return found
