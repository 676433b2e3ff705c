"""Changes of the weather's light and fog in each tracker's world, drawn from `LightConfig`."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.rng import EpisodeKey
from eyas.core.variation import sample
from eyas.sim.worlds import Worlds
from eyas.state.lighting import Lighting
from eyas.world.config import LightConfig

__all__ = ["LightChanges"]

_UNCHANGED = LightConfig()


class LightChanges:
    """Draws light and fog for N trackers.

    As in the original, the luminosity of a world is 1 by day and 0.3 at night; a change is added to
    it or replaces it, and the result is at least 0. Unlike in the original, changes do not
    accumulate over resets.

    Args:
        config: The settings.
        weather: The weather's own light.
        worlds: The worlds of the trackers; those in one world share its light.
        factors: `Snapshot.light`, shape (N, 3); set here.
    """

    def __init__(
        self,
        config: LightConfig,
        weather: Lighting,
        worlds: Worlds,
        factors: NDArray[np.float32],
    ) -> None:
        self._config = config
        self._changes = config != _UNCHANGED
        self._weather = weather
        self._worlds = worlds
        self._factors = factors
        factors[:] = 1.0, 1.0, weather.fog_density

    def sample(self, tracker: int, key: EpisodeKey) -> None:
        """Draw the light around a tracker; the leader of a world draws for all its trackers."""
        fixed = key.episode > 0 and not self._config.each_reset
        if not self._changes or fixed or tracker != self._worlds.leader[self._worlds.of[tracker]]:
            return
        rng = key.stream("light")
        config, weather = self._config, self._weather
        sky = _changed(
            sample(config.background, rng), config.background_replaces, weather.luminosity
        )
        sun = _changed(sample(config.sun, rng), config.sun_replaces, weather.luminosity)
        density = weather.fog_density
        if weather.foggy and config.visibility is not None:
            density = 1.0 / sample(config.visibility, rng)
        self._factors[self._worlds.trackers_of(tracker)] = sky, sun, density

    def of(self, trackers: NDArray[np.integer]) -> NDArray[np.float32] | None:
        """Return `Views.light` of trackers; None if the light of the weather is unchanged."""
        return self._factors.take(trackers, axis=0) if self._changes else None


def _changed(value: float, replaces: bool, own: float) -> float:
    """Return the factor on a luminosity."""
    return max(value if replaces else own + value, 0.0) / own
