"""Draw the gallery: a page of pictures of every map in every weather."""

import io
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from html import escape
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont
from rich.console import Console
from rich.progress import Progress

from eyas.engine.core.errors import OutputError
from eyas.engine.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.engine.core.installed import installed_version
from eyas.engine.sim.assets import load_assets
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.maps.gallery.places import (
    POSES,
    STOPS,
    all_cars,
    along,
    beside_most,
    horizon,
    on_open_roads,
    overview,
    stop,
)
from eyas.maps.gallery.still import StillScene, Viewpoint

# The page of a gallery: HTML without scripts, and a contact sheet of all pictures.

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


_PLAIN = 3.0  # Contrast of a distant view in which haze or fog leaves nothing to see [sRGB levels]


def choose_viewpoints(still: StillScene, sun: tuple[float, float, float]) -> list[Viewpoint]:
    """Return the viewpoints of a map, without those for which it has no suitable place.

    Args:
        sun: Direction to the sun; distant views have it behind the camera, so that walls are lit.
    """
    cars = all_cars(still)
    chosen: list[Viewpoint] = []
    for name, where, score in STOPS:
        chosen += stop(still, cars, name, where, score(still.scene, cars))
        if name == "span" and chosen and chosen[-1].name == "span-ahead":
            chosen += along(still, chosen[-1])
    if len(chosen) < 2 * len(POSES):
        chosen += stop(still, cars, "road", "on an open road", on_open_roads(still.scene, cars))
    sights = stop(still, cars, "sights", "where much stands around", beside_most(still, cars))
    chosen += [view for view in sights if view.position not in {one.position for one in chosen}]
    side = math.atan2(sun[1], sun[0]) + math.radians(15.0)
    far = horizon(still.scene, side)
    chosen.append(overview(still, side, cars))
    if still.contrast(far) > _PLAIN:
        chosen.append(far)
    first = chosen[0]
    small = replace(
        first,
        name="observation",
        title="84 x 84 pixels, enlarged",
        caption=f"{first.caption} As the 84 x 84 observation: 4:3 squeezed into a square, one "
        "sample a pixel, each pixel shown as 4 x 4.",
        size=(84, 84),
        samples=1,
        enlarged=4,
    )
    return [*chosen, small]


INDEX, SHEET = "index.html", "contact.png"

_OURS = re.compile(
    rf"{re.escape(INDEX)}|{re.escape(SHEET)}|\w+(-\w+)+(/[a-z]+(-[a-z]+)?\.png)?"
    rf"|(\w+(-\w+)+/)?\.[\w.-]+{re.escape(PART_SUFFIX)}"
)
"""Every path that a gallery can hold, relative to its folder."""


def run(out: Path, map_names: Sequence[str] = (), weather_names: Sequence[str] = ()) -> None:
    """Draw a gallery; the same version draws the same bytes.

    Args:
        out: The folder; an existing gallery in it is replaced.
        map_names: The maps; empty: all.
        weather_names: The weathers; empty: all.

    Raises:
        ConfigError: No such map or weather.
        OutputError: The folder holds other files, or writing failed.
    """
    wanted = conditions(map_names, weather_names)
    _check_folder(out)
    console = Console(stderr=True)
    with refusals(out):
        out.mkdir(parents=True, exist_ok=True)
        # The page marks a complete gallery, so it is deleted first and written last.
        (out / INDEX).unlink(missing_ok=True)
    with Progress(console=console, transient=True) as progress:
        shown = [_draw(out, *condition, progress) for condition in wanted]
    write_atomic(out / SHEET, png(contact_sheet(shown)))
    write_atomic(out / INDEX, page(shown, SHEET).encode())
    pictures = sum(len(one.views) for one in shown)
    console.print(f"{out / INDEX}: {pictures} pictures", highlight=False, markup=False)


def conditions(map_names: Sequence[str], weather_names: Sequence[str]) -> list[tuple[str, str]]:
    """Return the maps and weathers to draw, each pair once.

    If no map is named, all maps are drawn except those that lack one of the named weathers.

    Raises:
        UnknownNameError: No such map, or not in that weather.
    """
    every = sorted(MAPS.names())
    have = [name for name in every if set(weather_names) <= set(MAPS.get(name).weathers)]
    names = map_names or have or every
    pairs = [(name, kind) for name in names for kind in weather_names or MAPS.get(name).weathers]
    for name, weather in pairs:
        MAPS.get(name).light(weather)  # raises if the map lacks the weather
    return list(dict.fromkeys(pairs))


def _draw(out: Path, map_name: str, weather: str, progress: Progress) -> PageEntry:
    """Draw a map in a weather into the folder."""
    task = progress.add_task(f"{map_name}, {weather}", total=None)
    world = WorldConfig(map=map_name, weather=weather)
    still = StillScene(load_assets(world, TrafficConfig(), 1))
    recipe = MAPS.get(map_name)
    views = choose_viewpoints(still, recipe.light(weather).sun_direction)
    shown = PageEntry(recipe.name, weather, views, [still.rgb(view) for view in views])
    folder = out / shown.folder
    with refusals(folder):
        folder.mkdir(exist_ok=True)
    for view, picture in zip(views, shown.pictures, strict=True):
        write_atomic(folder / f"{view.name}.png", png(picture))
    progress.update(task, total=1, completed=1)
    return shown


def _check_folder(out: Path) -> None:
    """Refuse a folder that holds anything except a gallery, or parts of one."""
    with refusals(out):
        if not out.exists():
            return
        if not out.is_dir():
            raise OutputError(f"{out}: is a file; name a folder")
        for inside in sorted(out.rglob("*")):
            name = inside.relative_to(out).as_posix()
            if not _OURS.fullmatch(name) or inside.is_symlink():
                raise OutputError(f"{out}: not a gallery: it holds '{name}'; name another folder")
        index = out / INDEX
        if index.exists() and MARK not in index.read_text(errors="replace"):
            raise OutputError(
                f"{out}: not a gallery: its {INDEX} was not made by Eyas; name another folder"
            )
