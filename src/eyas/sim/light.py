"""What each tracker's world changes of the weather's light and fog, drawn by `LightConfig`."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.rng import stream
from eyas.core.variation import draw
from eyas.state.scene import Lighting
from eyas.world.config import LightConfig

__all__ = ["LightChanges"]

_UNCHANGED = LightConfig()


class LightChanges:
    """Draws light and fog for N trackers.

    As in the original, luminosities are those of its worlds: 1 by day, 0.3 at night; a change is
    added to that or takes its place, and none falls below 0. Unlike there, changes do not pile up
    from reset to reset.

    Attributes:
        factors: For each tracker the factor on the sky and its light, the factor on the sun, and
            one over the visibility range [1/m], shape (N, 3).

    Args:
        config: The settings.
        weather: The weather's own light.
        foggy: Whether the weather has a visibility range to change.
        count: N.
        shared: One world for all trackers, or one for each.
    """

    def __init__(
        self, config: LightConfig, weather: Lighting, count: int, *, foggy: bool, shared: bool
    ) -> None:
        self._config = config
        self._weather = weather
        self._foggy = foggy
        self._shared = shared
        self.factors = np.tile(np.array([1.0, 1.0, weather.fog_density], np.float32), (count, 1))

    def draw(self, tracker: int, seed: int, episode: int) -> None:
        """Draw the light around a tracker; in a shared world tracker 0 draws for all."""
        fixed = episode > 0 and not self._config.each_reset
        if fixed or (self._shared and tracker > 0):
            return
        rng = stream(seed, "light", tracker, episode)
        config, weather = self._config, self._weather
        sky = _changed(draw(config.background, rng), config.background_replaces, weather.luminosity)
        sun = _changed(draw(config.sun, rng), config.sun_replaces, weather.luminosity)
        density = weather.fog_density
        if self._foggy and config.visibility is not None:
            density = 1.0 / draw(config.visibility, rng)
        rows = slice(None) if self._shared else tracker
        self.factors[rows] = sky, sun, density

    def of(self, trackers: NDArray[np.integer]) -> NDArray[np.float32] | None:
        """Return `Views.light` of trackers, None where the weather is left as it is."""
        return self.factors.take(trackers, axis=0) if self._config != _UNCHANGED else None


def _changed(value: float, replaces: bool, own: float) -> float:
    """Return the factor on a luminosity."""
    return max(value if replaces else own + value, 0.0) / own
