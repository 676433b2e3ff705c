"""`eyas verify`."""

from typing import Annotated

import typer

from eyas.cli.options import MapName

__all__ = ["command"]


def command(
    quick: Annotated[
        bool, typer.Option("--quick", help="Look at a tenth of the cases only.")
    ] = False,
    map_: MapName = None,
    json_: Annotated[bool, typer.Option("--json", help="Print JSON, with all hashes.")] = False,
) -> None:
    """Check that this machine computes the promised bytes: pictures, labels, rewards, people.

    Exit code 1 if anything differs.
    """
    from eyas.modes.verify.run import run

    if not run(quick=quick, map_name=map_, as_json=json_):
        raise typer.Exit(1)
