"""The air between the camera and things."""

from eyas.lanes import kernel
from eyas.lanes.vector import lesser
from eyas.render.kernels.bundles import Illumination
from eyas.render.kernels.scalars import f4

__all__ = ["HAZE_END", "fog_share", "hidden_at"]

HAZE_END = 4.0
"""Distance beyond which land gets no hazier, and at which the hills begin [km]. So the foot of
the hills matches the end of the land, however high the viewer is."""

_FARTHEST = f4(1000.0 * HAZE_END)


@kernel(inline=True)
def hidden_at(lit: Illumination, distance: float) -> float:
    """Return how much of what lies at a distance [m] the air hides, 0 to 1."""
    thickness = distance * lit.fog_density
    if lit.air.power > f4(1.5):
        thickness *= thickness
    # 1 - exp(-t) as (1 + t/8 + (t/8)^2 / 2)^-8: within 0.003 of it, and several times as fast.
    eighth = f4(0.125) * thickness
    power = f4(1.0) + eighth * (f4(1.0) + f4(0.5) * eighth)
    power *= power
    power *= power
    return f4(1.0) - f4(1.0) / (power * power)


@kernel(inline=True)
def fog_share(lit: Illumination, distance: float) -> float:
    """Return how much of what lies at a distance [m] the air hides, 0 to 1; see `HAZE_END`."""
    return hidden_at(lit, lesser(distance, _FARTHEST))
