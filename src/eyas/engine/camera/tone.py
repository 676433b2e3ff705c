"""Radiances as bytes by the renderer's own curve: what is shown where no imager is modelled."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.light.tone import TONE_STEPS, TONE_TOP
from eyas.engine.render.kernels.pixels import pack
from eyas.engine.render.kernels.scalars import f4
from eyas.engine.render.pack.light import tone_table
from eyas.lanes import kernel, parallel, thread_count
from eyas.lanes.vector import WIDTH, gather, greater, lesser, load, store_triples, to_i4

_LAST_STEP = f4(TONE_STEPS - 1)


class ToneCurve:
    """The renderer's curve, see `eyas.engine.render.pack.light.tone_table`.

    Args:
        exposure: Factor on radiances, see `eyas.engine.state.lighting.Lighting`.
    """

    def __init__(self, exposure: float) -> None:
        self._table = tone_table()
        # As `tone_byte` has it, so that the bytes are those of the renderer.
        self._scale = float(np.float32(exposure) * np.float32(TONE_STEPS / TONE_TOP))

    def develop(self, radiance: NDArray[np.float32], rgb: NDArray[np.uint8]) -> None:
        """Write the bytes of pictures.

        Args:
            radiance: Shape (V, 3, H, W).
            rgb: sRGB, shape (V, H, W, 3), written in place.
        """
        views = len(radiance)
        work = _Work(
            radiance.reshape(views, 3, -1), rgb.reshape(views, -1), self._table, self._scale
        )
        _tone(min(thread_count(), views), work)


class _Work(NamedTuple):
    """Inputs and outputs of the kernel."""

    radiance: NDArray[np.float32]  # Shape (V, 3, pixels)
    rgb: NDArray[np.uint8]  # Shape (V, bytes of a picture)
    table: NDArray[np.uint8]
    scale: float  # Steps of the table in a unit of radiance


@kernel(inline=True)
def _toned(work: _Work, view: int, channel: int, at: int) -> int:
    """Return the bytes of eight pixels in one colour."""
    step = greater(load(work.radiance[view, channel], at) * f4(work.scale), f4(0.0))
    toned: int = gather(work.table, to_i4(lesser(step, _LAST_STEP)))
    return toned


@parallel
def _tone(worker: int, workers: int, work: _Work) -> None:
    """Tone the pictures whose turn is this worker's."""
    pixels = work.radiance.shape[2]
    for view in range(worker, work.radiance.shape[0], workers):
        for first in range(0, pixels, WIDTH):
            at = min(first, pixels - WIDTH)  # the last eight may be written twice
            red, green, blue = (
                _toned(work, view, 0, at), _toned(work, view, 1, at), _toned(work, view, 2, at),
            )  # fmt: skip
            store_triples(work.rgb[view], 3 * at, pack(red, green, blue))
