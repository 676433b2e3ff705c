"""`eyas maps`."""

from pathlib import Path
from typing import Annotated

import typer

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
