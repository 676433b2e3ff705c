"""`eyas cache`."""

from typing import Annotated

import typer

from eyas.cli.options import SEVERAL

__all__ = ["app"]

app = typer.Typer(
    help="Show, delete or make the files that Eyas keeps on disk.", no_args_is_help=True
)


@app.command()
def info() -> None:
    """Print the folder, size, size limit and contents of the cache."""
    from eyas.modes import cache

    cache.run_info()


@app.command()
def clear(
    kind: Annotated[
        str | None, typer.Option("--kind", help="Only this kind, as `eyas cache info` names it.")
    ] = None,
) -> None:
    """Delete the contents of the cache; they are made again when they are needed."""
    from eyas.modes import cache

    cache.run_clear(kind)


@app.command()
def warm(
    map_name: Annotated[
        list[str] | None,
        typer.Option("--map", help=f"Only this map; {SEVERAL}."),
    ] = None,
    weather: Annotated[
        list[str] | None,
        typer.Option("--weather", help=f"Only this weather; {SEVERAL}."),
    ] = None,
) -> None:
    """Make what the default settings need now, not on first use: for images of a cluster."""
    from eyas.modes.cache import run_warm

    run_warm(map_name or (), weather or ())
