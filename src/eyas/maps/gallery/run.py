"""Draw the gallery: a page of pictures of every map in every weather."""

import math
import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from eyas.engine.core.errors import OutputError
from eyas.engine.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.engine.sim.assets import load_assets
from eyas.engine.traffic.config import TrafficConfig
from eyas.engine.world.config import WorldConfig
from eyas.engine.world.maps import MAPS
from eyas.maps.gallery.page import MARK, PageEntry, contact_sheet, page, png
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

_PLAIN = 2.0  # Contrast of a distant view in which haze or fog leaves nothing to see [sRGB levels]


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
