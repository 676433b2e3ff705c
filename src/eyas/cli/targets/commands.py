"""`eyas targets`."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eyas.engine.terminal.options import AsJson, to_write

if TYPE_CHECKING:
    from eyas.engine.custom.config import CustomConfig

_WIDTH = 190  # Width of the table [characters]; a narrower terminal breaks its lines

_Scale = Annotated[float, typer.Option("--scale", help="Metres in the mesh file's unit.")]
_Up = Annotated[str | None, typer.Option("--up", help="The mesh file's axis that is up: y or z.")]
_Turn = Annotated[float, typer.Option("--turn", help="Turn the mesh about its height, in radians.")]
_Most = Annotated[
    int | None, typer.Option("--most-triangles", help="Simplify larger meshes to so many.")
]

app = typer.Typer(help="List and draw what can be followed.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("list")
def list_targets(*, as_json: AsJson = False) -> None:
    """Print all targets with their sizes, motion, numbers of triangles and looks."""
    from rich.console import Console

    from eyas.cli.targets.listing import entries, table

    if as_json:
        typer.echo(json.dumps([asdict(entry) for entry in entries()], indent=1))
        return
    Console(width=_WIDTH).print(table())


@app.command("check")
def check_target(
    what: Annotated[
        str,
        typer.Argument(
            help="A name of the list, a mesh file, a trajectory (.csv), or package.module:Class."
        ),
    ],
    scale: _Scale = 1.0,
    up: _Up = None,
    most_triangles: _Most = None,
    map_name: Annotated[
        str, typer.Option("--map", help="Map on which it is to move.")
    ] = "citystreet",
) -> None:
    """Check whether a target can be used; the exit code is 1 if it cannot."""
    from eyas.cli.targets.check import check

    config = _reading(scale=scale, up=up, most_triangles=most_triangles)
    lines, usable = check(what, config, map_name)
    for line in lines:
        typer.echo(line)
    if not usable:
        raise typer.Exit(1)


@app.command("show")
def show_target(
    name: Annotated[
        str,
        typer.Argument(
            help="Name of a model or a kind, `all`, a mesh file, or package.module:Class."
        ),
    ],
    out: Annotated[
        Path | None,
        to_write("File to write: .png, or .gif, .webp or .apng (a film); by default NAME.png."),
    ] = None,
    scale: _Scale = 1.0,
    up: _Up = None,
    turn: _Turn = 0.0,
    most_triangles: _Most = None,
) -> None:
    """Draw a target from all sides, in motion, and from the height of a tracker."""
    from eyas.cli.targets.show import run

    path = out if out is not None else Path(f"{Path(name).name.replace(':', '.')}.png")
    run(name, path, _reading(scale=scale, up=up, turn=turn, most_triangles=most_triangles))
    typer.echo(path)


def _reading(**said: object) -> "CustomConfig":
    """Return how a mesh file is read."""
    from eyas.engine.core.config import validated
    from eyas.engine.custom.config import CustomConfig

    return validated(CustomConfig, {"path": "-", **said}, "custom")
