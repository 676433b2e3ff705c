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
    """Print all targets with their sizes, colours, motion and numbers of triangles."""
    from rich.console import Console

    from eyas.modes.targets.listing import table

    Console(width=_WIDTH).print(table())


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
