"""Conversion of light to bytes."""

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.scalars import f4, i8, u4

__all__ = ["TONE_STEPS", "TONE_TOP", "tone_byte"]


TONE_STEPS = 16384
"""Length of `Light.tone`."""

TONE_TOP = 4.0
"""Exposed radiance at the end of that table."""

_STEPS_PER_UNIT = f4(TONE_STEPS / TONE_TOP)
_LAST_STEP = f4(TONE_STEPS - 1)


@inlined_kernel
def tone_byte(light: Light, radiance: float) -> int:
    """Return the byte of the picture for a radiance."""
    step = radiance * light.air[2] * _STEPS_PER_UNIT
    # Written so that NaN, for which every comparison is false, becomes black, not an index error.
    return i8(light.tone[u4(min(step, _LAST_STEP))]) if step > f4(0.0) else i8(light.tone[0])
