"""The renderer of this processor where programs ask for one of a device, that is `HostDevice`."""

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from eyas.engine.render.kernels.bundles import Movers
from eyas.engine.state.draw import DrawList, Picture, Renderer, Views
from eyas.engine.state.lighting import LightState
from eyas.gpu.render.device_views import DeviceViews


@dataclass(slots=True)
class _Cameras(Views):
    """Views whose focal lengths are known."""

    lengths: NDArray[np.float64] | None = None

    def focal(self, height: int, width: int) -> NDArray[np.float64]:
        """See `Views`."""
        assert self.lengths is not None
        return self.lengths


class HostRenderer:
    """Draws what lies in the memory of this processor, see `DeviceDrawer`."""

    def __init__(
        self,
        renderer: Renderer,  # What draws
        samples: int = 1,  # Samples per pixel
        *,
        tent: bool = True,  # See `Views`
    ) -> None:
        self._renderer, self._samples, self._tent = renderer, samples, tent

    def draw(
        self,
        cameras: DeviceViews,
        movers: Movers,
        rgb: Any,  # noqa: ANN401  # as there
        subject: Any = None,  # noqa: ANN401  # as there
    ) -> None:
        """Draw the pictures of V cameras, see `DeviceDrawer`."""
        count = cameras.views
        views = _Cameras(
            position=cameras.eye[:count],
            rotation=cameras.axes[:count].swapaxes(1, 2),
            world=cameras.world[:count],
            subject=cameras.subject[:count],
            field_of_view=0.0,
            light=LightState(*(array[:count] for array in cameras.light)),
            instant=cameras.instant[:count] if len(cameras.instant) else None,
            falling=cameras.falling,
            tent=self._tent,
            lengths=cameras.focal[:count],
        )
        drawn = DrawList(**{array.name: getattr(movers, array.name) for array in fields(DrawList)})
        picture = Picture.create(count, 1, 1, rgb=False, subject=subject is not None)
        picture.rgb = rgb[:count]
        self._renderer.draw(views, drawn, picture, self._samples)
        if subject is not None:
            boxes = picture.subject_box, picture.subject_pixels, picture.subject_visible_box
            columns = [array for array in boxes if array is not None]  # all three
            subject[:count] = np.concatenate(columns, axis=1)
