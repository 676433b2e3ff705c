"""The light of one view: the weather's, with the changes of the view."""

import numpy as np
from numpy.typing import NDArray

from eyas.lanes import kernel
from eyas.render.kernels.bundles import Air, Direction, Illumination
from eyas.render.kernels.scalars import f4

__all__ = ["view_light"]


@kernel(inline=True)
def _scaled(share: float, colour: Direction) -> Direction:
    return Direction(share * colour.x, share * colour.y, share * colour.z)


@kernel(inline=True)
def view_light(weather: Illumination, change: NDArray[np.float32]) -> Illumination:
    """Return the light of a view.

    The air's colour is scattered light of the sky; light reflected by the ground comes from both
    sky and sun.

    Args:
        weather: Light of the weather.
        change: Factor on the sky, factor on the sun, fog density [1/m], shape (3,).
    """
    sky, sun = change[0], change[1]
    return Illumination(
        weather.sun,
        _scaled(sun, weather.sun_colour),
        _scaled(sky, weather.zenith),
        _scaled(sky, weather.horizon),
        _scaled(sky, weather.above),
        _scaled(f4(0.5) * (sky + sun), weather.below),
        _scaled(sky, weather.fog),
        _air(weather.air, change[2]),
    )


@kernel(inline=True)
def _air(air: Air, density: float) -> Air:
    """Return the air with another density of fog."""
    return Air(
        density, air.power, air.exposure, air.offset, air.snow, air.lamps, air.windows,
        air.clouds, air.flakes,
    )  # fmt: skip
