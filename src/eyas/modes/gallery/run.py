"""Draw the gallery: a page of pictures of every map in every weather."""

import re
from collections.abc import Sequence
from pathlib import Path

from rich.console import Console
from rich.progress import Progress

from eyas.core.errors import OutputError
from eyas.core.files import PART_SUFFIX, refusals, write_atomic
from eyas.modes.gallery.page import MARK, Shown, contact_sheet, page, png
from eyas.modes.gallery.still import StillScene
from eyas.modes.gallery.views import choose_viewpoints
from eyas.sim.assets import load_assets
from eyas.traffic.config import TrafficConfig
from eyas.world.config import WorldConfig
from eyas.world.maps import MAPS

__all__ = ["INDEX", "SHEET", "conditions", "run"]

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


def _draw(out: Path, map_name: str, weather: str, progress: Progress) -> Shown:
    """Draw a map in a weather into the folder."""
    task = progress.add_task(f"{map_name}, {weather}", total=None)
    world = WorldConfig(map=map_name, weather=weather)
    still = StillScene(load_assets(world, TrafficConfig(), 1))
    recipe = MAPS.get(map_name)
    views = choose_viewpoints(still, recipe.light(weather).sun_direction)
    shown = Shown(recipe.name, weather, views, [still.rgb(view) for view in views])
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
