"""Changes of the weather's light and fog in each tracker's world, sampled from `LightConfig`."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.core.rng import EpisodeKey
from eyas.engine.core.variation import Rule, rule_of, sampled
from eyas.engine.state.lighting import Lighting, LightState
from eyas.engine.trackers.wind import mean_wind
from eyas.engine.world.config import LightConfig, WorldWindConfig
from eyas.lanes import kernel

_UNCHANGED = LightConfig()


class LightRules(NamedTuple):
    """How light and fog are sampled; 1 means yes, 0 no."""

    changes: int  # Whether anything is sampled
    each_reset: int  # Whether it is sampled for each episode, not only for the first
    sky: Rule
    sun: Rule
    visibility: Rule  # [m]
    sky_replaces: int
    """Whether the sampled luminosity replaces that of the weather, or is added to it."""
    sun_replaces: int
    visible: int  # Whether the visibility is sampled, or that of the weather
    luminosity: float  # Of the weather
    fog_density: float  # Of the weather [1/m]


@kernel
def change_light(rules: LightRules, state: NDArray[np.int64]) -> tuple[float, float, float]:
    """Draw factors on the sky's light and the sun's, and the density of the fog [1/m].

    As in the original, the luminosity of a world is 1 by day and 0.3 at night; a change is added to
    it or replaces it, and the result is at least 0. Unlike in the original, changes do not
    accumulate over resets.

    Args:
        rules: How they are sampled.
        state: The random stream, see `eyas.lanes.pcg64`.
    """
    own = rules.luminosity
    sky = sampled(rules.sky, state) + (0.0 if rules.sky_replaces == 1 else own)
    sun = sampled(rules.sun, state) + (0.0 if rules.sun_replaces == 1 else own)
    density = rules.fog_density
    if rules.visible == 1:
        density = 1.0 / sampled(rules.visibility, state)
    return max(sky, 0.0) / own, max(sun, 0.0) / own, density


class LightChanges:
    """Light and fog of N trackers, which differ from those of the weather.

    Attributes:
        rules: How they are sampled.

    Args:
        config: The settings.
        weather: The weather's own light.
        changes: `Snapshot.light`; set here.
        wind: The wind; None: there is none.
    """

    def __init__(
        self,
        config: LightConfig,
        weather: Lighting,
        changes: LightState,
        wind: WorldWindConfig | None = None,
    ) -> None:
        self._wind = wind
        self._changes = changes
        changes.sky[:] = changes.sun[:] = 1.0
        changes.fog_density[:] = weather.fog_density
        visible = weather.foggy and config.visibility is not None
        self.rules = LightRules(
            changes=int(config != _UNCHANGED),
            each_reset=int(config.each_reset),
            sky=rule_of(config.background),
            sun=rule_of(config.sun),
            visibility=rule_of(1.0 if config.visibility is None else config.visibility),
            sky_replaces=int(config.background_replaces),
            sun_replaces=int(config.sun_replaces),
            visible=int(visible),
            luminosity=float(weather.luminosity),
            fog_density=float(weather.fog_density),
        )

    def of(self, trackers: NDArray[np.integer]) -> LightState | None:
        """Return `Views.light` of trackers; None if the light of the weather is unchanged."""
        if not self.rules.changes and self._wind is None:
            return None
        return LightState(*(array.take(trackers) for array in self._changes))

    def blow(self, tracker: int, key: EpisodeKey) -> None:
        """Draw the wind of a tracker's episode."""
        if self._wind is not None:
            speed, along = mean_wind(self._wind.speed, self._wind.direction, key.stream("wind"))
            self._changes.wind_x[tracker] = speed * along[0]
            self._changes.wind_y[tracker] = speed * along[1]
