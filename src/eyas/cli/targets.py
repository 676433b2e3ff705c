"""`eyas targets`."""

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["app"]

_WIDTH = 190
"""Of the table [characters]; a narrower terminal breaks its lines."""

app = typer.Typer(help="List and draw what can be followed.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("list")
def list_targets() -> None:
    """Print all targets with their sizes, motion, numbers of triangles and looks."""
    from rich.console import Console

    from eyas.modes.targets.listing import table

    Console(width=_WIDTH).print(table())


@app.command("check")
def check_target(
    what: Annotated[
        str,
        typer.Argument(
            help="A name of the list, a mesh file, a trajectory (.csv), or package.module:Class."
        ),
    ],
    scale: Annotated[float, typer.Option("--scale", help="Metres in the file's unit.")] = 1.0,
    up: Annotated[str | None, typer.Option("--up", help="Axis that is up: y or z.")] = None,
    most_triangles: Annotated[
        int | None, typer.Option("--most-triangles", help="Simplify larger meshes to so many.")
    ] = None,
    map_name: Annotated[
        str, typer.Option("--map", help="Map on which it is to move.")
    ] = "citystreet",
) -> None:
    """Tell whether a target can be used, and why not; the exit code is 1 if it cannot."""
    from eyas.core.config import validated
    from eyas.custom.config import CustomConfig
    from eyas.modes.targets.check import check

    said = {"path": "-", "scale": scale, "up": up, "most_triangles": most_triangles}
    lines, usable = check(what, validated(CustomConfig, said, "custom"), map_name)
    for line in lines:
        typer.echo(line)
    if not usable:
        raise typer.Exit(1)


@app.command("show")
def show_target(
    name: Annotated[str, typer.Argument(help="Name of a model or a kind, or `all`.")],
    out: Annotated[
        Path | None,
        typer.Option(
            "--out",
            help="File to write: .png, or .gif, .webp or .apng for a film; by default NAME.png.",
        ),
    ] = None,
) -> None:
    """Draw a target from all sides, in motion, and from the height of a tracker."""
    from eyas.modes.targets.show import run

    path = out if out is not None else Path(f"{name}.png")
    run(name, path)
    typer.echo(path)
