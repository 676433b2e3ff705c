"""`eyas maps`."""

import typer

__all__ = ["app"]

app = typer.Typer(help="Look at the maps.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command("list")
def list_maps() -> None:
    """Print the names of the maps, and which come later."""
    from eyas.world.maps import LATER, MAPS

    for name in sorted(MAPS):
        typer.echo(name)
    for name in sorted(LATER):
        typer.echo(f"{name} (not in this version)")
