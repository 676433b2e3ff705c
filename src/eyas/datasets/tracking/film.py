"""Films of tracked clips, with the box in each picture."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from eyas.datasets.tracking.clip import Clip, Picture
from eyas.engine.core.codecs.pyav import has_pyav
from eyas.engine.core.files import refusals
from eyas.engine.exports.mp4 import Mp4Episode
from eyas.engine.exports.webp import WebpEpisode

FILMS = "films"  # Folder of the films

_LONGEST = 1920  # Longest side of a film [pixels]: larger pictures are scaled
_USUAL_RATE = 25.0  # Pictures a second, where the clip has no rate [Hz]
_COLOUR, _CASING = (255, 196, 0), (10, 13, 18)


def draw_film(out: Path, clip: Clip, boxes: NDArray[np.float64]) -> None:
    """Write `films/<clip>.mp4`, without PyAV `.webp`; a film that exists is left as it is.

    Args:
        out: Folder of the results.
        clip: The pictures. Those of another size than the first are scaled to it.
        boxes: Left, top, width, height [pixels], without area where nothing is, shape (T, 4).

    Raises:
        OutputError: The film cannot be written.
    """
    path = out / FILMS / f"{clip.name}{'.mp4' if has_pyav() else '.webp'}"
    if path.exists():
        return
    with refusals(path.parent):
        path.parent.mkdir(exist_ok=True)
    width, height = clip.size
    scale = min(1.0, _LONGEST / max(width, height))
    size = max(round(width * scale), 2), max(round(height * scale), 2)
    kind = Mp4Episode if path.suffix == ".mp4" else WebpEpisode
    film = kind(path, size[1], size[0], getattr(clip, "fps", None) or _USUAL_RATE)
    try:
        for picture, box in zip(clip.pictures(), boxes.tolist(), strict=False):
            film.add_picture(_drawn(picture, box, size))
        film.finish()
    except BaseException:
        film.abandon()
        raise


def _drawn(picture: Picture, box: list[float], size: tuple[int, int]) -> Picture:
    """Return a picture of a size with the outline of a box on it."""
    image = Image.fromarray(picture)
    across, down = size[0] / image.width, size[1] / image.height
    image = image if image.size == size else image.resize(size)
    left, top, width, height = box
    if width > 0.0 and height > 0.0:
        # The box of a tracker may lie far beyond the picture.
        corners = np.array([left * across, top * down, (left + width) * across - 1.0,
                            (top + height) * down - 1.0])  # fmt: skip
        low, high = np.clip(corners.reshape(2, 2), -9.0, np.array(size) + 9.0).round().tolist()
        stroke = max(1, round(max(size) / 400))
        draw = ImageDraw.Draw(image)
        if high[0] >= low[0] and high[1] >= low[1]:
            for grown, colour, line in ((stroke, _CASING, 3 * stroke), (0, _COLOUR, stroke)):
                whole = (low[0] - grown, low[1] - grown, high[0] + grown, high[1] + grown)
                draw.rectangle(whole, outline=colour, width=line)
    return np.asarray(image)
