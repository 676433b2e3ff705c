"""`eyas maps`."""

from pathlib import Path
from typing import Annotated

import typer

from eyas.core.errors import ConfigError

__all__ = ["app"]

app = typer.Typer(help="List and draw the maps.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("list")
def list_maps() -> None:
    """Print the maps with their weathers, and the maps planned for later versions."""
    from eyas.world.maps import MAPS

    for name in sorted(MAPS.names()):
        recipe = MAPS.get(name)
        typer.echo(f"{name}: {recipe.title} ({', '.join(recipe.weathers)})")
    for name in sorted(MAPS.later):
        typer.echo(f"{name} (not in this version)")


@app.command("gallery")
def draw_gallery(
    out: Annotated[Path, typer.Option("--out", help="Folder to write to.")] = Path("runs/gallery"),
    map_name: Annotated[
        list[str] | None, typer.Option("--map", help="Only this map; may be given several times.")
    ] = None,
    weather: Annotated[
        list[str] | None,
        typer.Option("--weather", help="Only this weather; may be given several times."),
    ] = None,
) -> None:
    """Draw a page of pictures of each map in each weather."""
    from eyas.modes.gallery import run as gallery

    gallery.run(out, map_name or (), weather or ())


@app.command("import")
def import_map(
    file: Annotated[Path, typer.Argument(help="OpenStreetMap: .osm, .osm.gz or .osm.pbf.")],
    name: Annotated[str | None, typer.Option("--name", help="Name of the map.")] = None,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder of the map; then use --map FOLDER.")
    ] = None,
    bbox: Annotated[
        str | None, typer.Option("--bbox", help="Only WEST,SOUTH,EAST,NORTH, in degrees.")
    ] = None,
    traffic: Annotated[
        bool, typer.Option(help="Record the traffic now, not on first use.")
    ] = True,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the map.")] = False,
) -> None:
    """Make a map of an OpenStreetMap file; use it with --map NAME."""
    from eyas.modes.maps.importing import run

    bounds = _bounds(bbox)
    report = run(file, name, out=out, bounds=bounds, record=traffic, overwrite=overwrite)
    for line in report.lines():
        typer.echo(line)


def _bounds(text: str | None) -> tuple[float, float, float, float] | None:
    if text is None:
        return None
    try:
        west, south, east, north = (float(part) for part in text.split(","))
    except ValueError:
        raise ConfigError(
            f"--bbox: {text!r} is not allowed; allowed: WEST,SOUTH,EAST,NORTH in degrees"
        ) from None
    return west, south, east, north
