"""Pictures of a device beside those of the processor."""

import dataclasses

import numpy as np

from eyas.engine.state.draw import Picture
from eyas.gpu.render.read_back import ReadBackRenderer

__all__ = ["EVERYTHING", "differences"]

EVERYTHING = {"depth": True, "object_id": True, "subject": True, "class_id": True, "normal": True}


def differences(device, renderer, views, draw_list, *, size=(40, 52), samples=1, **wanted):
    """Return the names of what differs in the pictures of a device."""
    pictures = [Picture.create(len(views.position), *size, **wanted) for _ in range(2)]
    names = [field.name for field in dataclasses.fields(Picture)]
    names = [name for name in names if getattr(pictures[0], name) is not None]
    for drawing, picture in zip(
        (renderer, ReadBackRenderer(device, renderer)), pictures, strict=True
    ):
        for name in names:
            getattr(picture, name)[:] = 77  # what is not written shows
        drawing.draw(views, draw_list, picture, samples)
    near, far = pictures
    assert near.rgb is None or len(np.unique(near.rgb)) > 30
    return [name for name in names if not np.array_equal(getattr(near, name), getattr(far, name))]
