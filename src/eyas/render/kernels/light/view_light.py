"""The light of one view: the weather's, with the changes of the view."""

from eyas.lanes import kernel
from eyas.render.kernels.bundles import Direction, Illumination
from eyas.render.kernels.scalars import f4
from eyas.state.lighting import LightState

__all__ = ["view_light"]


@kernel(inline=True)
def _scaled(share: float, colour: Direction) -> Direction:
    return Direction(share * colour.x, share * colour.y, share * colour.z)


@kernel(inline=True)
def view_light(weather: Illumination, changes: LightState, view: int) -> Illumination:
    """Return the light of a view.

    The air's colour is scattered light of the sky; light reflected by the ground comes from both
    sky and sun.

    Args:
        weather: Light of the weather.
        changes: What differs from it.
        view: Number of the view.
    """
    sky, sun = changes.sky[view], changes.sun[view]
    return Illumination(
        weather.sun,
        _scaled(sun, weather.sun_colour),
        _scaled(sky, weather.zenith),
        _scaled(sky, weather.horizon),
        _scaled(sky, weather.above),
        _scaled(f4(0.5) * (sky + sun), weather.below),
        _scaled(sky, weather.fog),
        changes.fog_density[view],
        weather.air,
    )
