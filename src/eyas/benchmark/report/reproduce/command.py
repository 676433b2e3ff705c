"""`eyas reproduce`."""

from pathlib import Path
from typing import Annotated

import typer

from eyas.engine.terminal.options import Quiet, to_write

__all__ = ["reproduce"]


def reproduce(
    tables: Annotated[
        list[str] | None, typer.Argument(metavar="TABLE", help="Names of tables; none: list them.")
    ] = None,
    out: Annotated[
        Path, to_write("Folder for their evaluations; continued if interrupted.")
    ] = Path("runs/reproduce"),
    quiet: Quiet = False,
) -> None:
    """Fly tables of the documents again, and tell whether every printed digit is equal."""
    from eyas.benchmark.report.reproduce.run import listing, run

    if not tables:
        typer.echo(listing())
        return
    if not run(tuple(tables), out, quiet=quiet):
        raise typer.Exit(1)
