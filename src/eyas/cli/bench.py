"""`eyas bench`."""

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["command"]


def command(
    out: Annotated[
        Path | None, typer.Option("--out", help="JSON file to write the figures to, as well.")
    ] = None,
    quick: Annotated[
        bool, typer.Option("--quick", help="Measure for a tenth of the time.")
    ] = False,
    cold: Annotated[
        bool, typer.Option("--cold", help="Also time a first picture with an empty cache.")
    ] = False,
    stages: Annotated[
        bool, typer.Option("--stages", help="Also time each stage of drawing a picture.")
    ] = False,
) -> None:
    """Measure the speed of Eyas on this machine, as medians."""
    from eyas.modes.bench import run as bench

    bench.run(out, quick=quick, cold=cold, stages=stages)
