"""Conversion of light to bytes."""

from eyas.engine.render.kernels.bundles import Light
from eyas.engine.render.kernels.scalars import f4
from eyas.lanes import kernel
from eyas.lanes.vector import gather, greater, lesser, to_i4

TONE_STEPS = 16384  # Length of `Light.tone`.

TONE_TOP = 4.0  # Exposed radiance at the end of that table

_STEPS_PER_UNIT = f4(TONE_STEPS / TONE_TOP)
_LAST_STEP = f4(TONE_STEPS - 1)


@kernel(inline=True)
def tone_byte(light: Light, exposure: float, radiance: float) -> int:
    """Return the byte of the picture for a radiance."""
    # In this order NaN, for which every comparison is false, becomes black, not an index error.
    step = greater(radiance * (exposure * _STEPS_PER_UNIT), f4(0.0))
    return gather(light.tone, to_i4(lesser(step, _LAST_STEP)))


@kernel(inline=True)
def tone_bytes(
    light: Light, exposure: float, colour: tuple[float, float, float]
) -> tuple[int, int, int]:
    """Return the bytes of red, green and blue."""
    return (
        tone_byte(light, exposure, colour[0]),
        tone_byte(light, exposure, colour[1]),
        tone_byte(light, exposure, colour[2]),
    )
