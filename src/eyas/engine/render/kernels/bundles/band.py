"""All that the drawing of one band of a view reads and writes but its outputs."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles.geometry import Geometry, Movers
from eyas.engine.render.kernels.bundles.lens import Glass
from eyas.engine.render.kernels.bundles.light import Illumination, Light
from eyas.engine.render.kernels.bundles.view import View


class Band(NamedTuple):
    """A band of a view, and the memory of the worker that draws it.

    It is filled once (`eyas.engine.render.kernels.draw.band_of`) and handed on by address. A loop
    reads the arrays that it needs into names of its own first: through the address they would be
    loaded again after each store.
    """

    geometry: Geometry
    light: Light
    lit: Illumination  # Light and air of the view
    movers: Movers
    world: int  # The view's, a row of `movers`
    camera: View  # Not `view`: numba takes that for the method of arrays
    until: int  # The last `eyas.engine.state.draw.DrawStage`.
    columns: int
    """Width and height of what the band writes [pixels]: the camera's own, but through a lens."""
    lines: int
    glass: Glass
    key: NDArray[np.int64]
    """This and the following: the worker's rows of `Scratch`; of this, `alone` and `shade` only as
    many rows of samples as the band has."""
    alone: NDArray[np.int64]
    shade: NDArray[np.uint8]
    drawn: NDArray[np.int32]
    mesh: NDArray[np.int32]
    tiles: NDArray[np.float32]
    order: NDArray[np.int64]
    triangle: NDArray[np.float64]
    polygon: NDArray[np.float64]
    span: NDArray[np.int32]
    leaning: NDArray[np.float32]
    item: NDArray[np.float64]
    item_row: NDArray[np.int64]
    seen: NDArray[np.int64]
    found: NDArray[np.int64]
    record: NDArray[np.float64]
    record_shown: NDArray[np.int64]
    unit: NDArray[np.int32]
    recorded: NDArray[np.int64]
    member: int
    """Which of several workers that share the band this is: each does its own items of lists and
    its own rows. On a processor, one does all."""
    members: int  # How many they are
