"""The page of a gallery: HTML without scripts, and a contact sheet of all pictures."""

import io
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from eyas.engine.core.installed import installed_version
from eyas.maps.gallery.still import Viewpoint

MARK = '<meta name="generator" content="eyas maps gallery">'
"""Text by which the page of a gallery is recognised."""

_THUMBNAIL = (320, 240)
_COLUMNS = 3
_MARGIN, _LABEL = 12, 36
_BACK, _INK, _DIM = (24, 25, 27), (230, 230, 228), (160, 161, 163)

_STYLE = """
:root { color-scheme: dark; }
body { margin: 0 auto; padding: 2rem 1.5rem 4rem; max-width: 1344px; background: #18191b;
  color: #e6e6e4; font: 16px/1.5 system-ui, sans-serif; }
h1 { margin: 0; font-size: 1.6rem; font-weight: 600; }
h2 { margin: 2.5rem 0 1rem; font-size: 1.25rem; font-weight: 600; }
p { margin: .4rem 0; color: #a0a1a3; }
a { color: #9cc4e4; }
.views { display: grid; gap: 1.75rem 1.5rem;
  grid-template-columns: repeat(auto-fill, minmax(min(100%, 420px), 1fr)); }
figure { margin: 0; }
img { display: block; width: 100%; height: auto; border-radius: 4px; background: #0f1011; }
img.pixels { width: auto; max-width: 100%; image-rendering: pixelated; }
figcaption { margin-top: .5rem; font-size: .875rem; color: #a0a1a3; }
figcaption strong { display: block; font-size: 1rem; font-weight: 600; color: #e6e6e4; }
"""


@dataclass(frozen=True, slots=True)
class PageEntry:
    """A map in a weather, and its pictures."""

    map_name: str
    weather: str
    views: Sequence[Viewpoint]
    pictures: Sequence[NDArray[np.uint8]]  # sRGB of each view, shape (H, W, 3)

    @property
    def folder(self) -> str:
        """Name of the folder of its pictures, beside the page."""
        return f"{self.map_name}-{self.weather}"


def page(
    shown: Sequence[PageEntry],
    sheet: str,  # Name of the file of the contact sheet
) -> str:
    """Return the page, which needs only the pictures beside it."""
    what = " &middot; ".join(f'<a href="#{_id(one)}">{_heading(one)}</a>' for one in shown)
    sections = "\n".join(_section(one) for one in shown)
    return f"""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
{MARK}
<title>Eyas: gallery of the maps</title>
<style>{_STYLE}</style>
</head>
<body>
<h1>Gallery of the maps</h1>
<p>Drawn by Eyas {escape(installed_version())} from fixed viewpoints.
<a href="{escape(sheet)}">All of them in one picture</a></p>
<p>{what}</p>
{sections}
</body>
</html>
"""


def _section(one: PageEntry) -> str:
    figures = "\n".join(
        _figure(one, view, picture) for view, picture in zip(one.views, one.pictures, strict=True)
    )
    return (
        f'<section id="{_id(one)}">\n<h2>{_heading(one)}</h2>\n'
        f'<div class="views">\n{figures}\n</div>\n</section>'
    )


def _figure(one: PageEntry, view: Viewpoint, picture: NDArray[np.uint8]) -> str:
    height, width = picture.shape[:2]
    source = escape(f"{one.folder}/{view.name}.png")
    alt = escape(f"{one.map_name}, {one.weather}. {view.title}. {view.caption}")
    pixels = ' class="pixels"' if view.enlarged > 1 else ""
    return (
        f'<figure><a href="{source}"><img{pixels} src="{source}" width="{width}" '
        f'height="{height}" alt="{alt}"></a>\n'
        f"<figcaption><strong>{escape(view.title)}</strong>{escape(view.caption)}"
        "</figcaption></figure>"
    )


def _id(one: PageEntry) -> str:
    return escape(one.folder)


def _heading(one: PageEntry) -> str:
    return escape(f"{one.map_name}, {one.weather}")


def contact_sheet(shown: Sequence[PageEntry]) -> NDArray[np.uint8]:
    """Return small versions of all pictures, with names under them, sRGB, shape (H, W, 3)."""
    rows = sum(-(-len(one.views) // _COLUMNS) for one in shown)
    wide, high = _THUMBNAIL[0] + _MARGIN, _THUMBNAIL[1] + _LABEL
    size = (_MARGIN + _COLUMNS * wide, _MARGIN + len(shown) * _LABEL + rows * high)
    sheet = Image.new("RGB", size, _BACK)
    pen = ImageDraw.Draw(sheet)
    top = _MARGIN
    for one in shown:
        pen.text((_MARGIN, top), f"{one.map_name}, {one.weather}", _INK, ImageFont.load_default(20))
        top += _LABEL
        for index, (view, rgb) in enumerate(zip(one.views, one.pictures, strict=True)):
            left = _MARGIN + index % _COLUMNS * wide
            y = top + index // _COLUMNS * high
            small = Image.fromarray(rgb)
            small.thumbnail(_THUMBNAIL, Image.Resampling.LANCZOS)
            sheet.paste(small, (left, y))
            font = ImageFont.load_default(14)
            pen.text((left, y + _THUMBNAIL[1] + 4), view.title, _DIM, font)
        top += -(-len(one.views) // _COLUMNS) * high
    return np.asarray(sheet)


def png(rgb: NDArray[np.uint8]) -> bytes:
    """Return a picture as a PNG file; the same picture gives the same bytes."""
    buffer = io.BytesIO()
    Image.fromarray(rgb).save(buffer, "PNG")
    return buffer.getvalue()
