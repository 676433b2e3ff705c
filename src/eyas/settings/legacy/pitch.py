"""The camera's pitch, which the original limits to what its gimbal reaches."""

from collections.abc import Iterator
from dataclasses import dataclass

from typing_extensions import override

from eyas.core.config import shown
from eyas.settings.legacy.entries import Values, Varied

__all__ = ["Pitch"]

_LEAST, _MOST = 0.5, 1.5
"""The pitches that the gimbal reaches [rad]."""

_FLATTEST, _STEEPEST = 0.1, 3.0
"""The pitches for which there is a start position [rad]; see `StartConfig.pitch`."""


@dataclass(frozen=True, slots=True)
class Pitch(Varied):
    """A pitch; one that looks at or above the horizon, or far behind, is limited.

    Others keep their value, because the start position is computed from it.
    """

    @override
    def read(self, values: Values) -> Values:
        # Not `super()`, which a dataclass with slots breaks.
        return Varied.read(self, {**values, **self._limited(values)})

    @override
    def remarks(self, values: Values) -> Iterator[str]:
        for key, used in self._limited(values).items():
            yield (
                f"{key}: {shown(values[key])} is out of the gimbal's range of {_LEAST} to {_MOST};"
                f" {used} is used"
            )

    def _limited(self, values: Values) -> dict[str, float]:
        """Return the keys in use whose values are limited."""
        keys = (self.least, self.most) if values[self.random] else (self.fixed,)
        limited = {}
        for key in keys:
            value = values[key]
            assert isinstance(value, int | float), "the adapter has checked the types"
            if not _FLATTEST <= value <= _STEEPEST:
                limited[key] = _LEAST if value < _FLATTEST else _MOST
        return limited
