"""The light of one view: the weather's, with the changes of the view."""

import numpy as np
from numpy.typing import NDArray

from eyas.core.jit import inlined_kernel
from eyas.render.kernels.bundles import Light
from eyas.render.kernels.scalars import f4

__all__ = ["view_light"]


@inlined_kernel
def view_light(light: Light, change: NDArray[np.float32], rows: NDArray[np.float32]) -> Light:
    """Return the light of a view, kept in working memory.

    The air's colour is scattered light of the sky; light reflected by the ground comes from both
    sky and sun.

    Args:
        light: Light of the weather.
        change: Factor on the sky, factor on the sun, fog density [1/m], shape (3,).
        rows: Working memory, see `Scratch.light`.
    """
    sky, sun = change[0], change[1]
    for k in range(3):
        rows[0, k] = sun * light.sun_colour[k]
        rows[1, k] = sky * light.zenith[k]
        rows[2, k] = sky * light.horizon[k]
        rows[3, k] = sky * light.ambient_up[k]
        rows[4, k] = f4(0.5) * (sky + sun) * light.ambient_down[k]
        rows[5, k] = sky * light.fog[k]
    for k in range(len(light.air)):
        rows[6, k] = light.air[k]
    rows[6, 0] = change[2]
    return Light(
        light.sun,
        rows[0, :3],
        rows[1, :3],
        rows[2, :3],
        rows[3, :3],
        rows[4, :3],
        rows[5, :3],
        rows[6],
        light.shadow_map,
        light.shadow_rows,
        light.ambient,
        light.ambient_frame,
        light.lamp,
        light.lamp_cell,
        light.lamp_frame,
        light.tracks,
        light.track_frame,
        light.tone,
        light.ground,
        light.clouds,
        light.hills,
    )
