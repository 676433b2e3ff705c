"""`eyas bench`."""

from pathlib import Path
from typing import Annotated

import typer

__all__ = ["command"]


def command(
    json: Annotated[Path | None, typer.Option("--json", help="Write the figures here too.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="A tenth of the time.")] = False,
    cold: Annotated[
        bool, typer.Option("--cold", help="Also the first picture with nothing compiled yet.")
    ] = False,
    stages: Annotated[
        bool, typer.Option("--stages", help="Also where the time of a picture goes.")
    ] = False,
) -> None:
    """Measure how fast this machine runs Eyas; prints medians."""
    from eyas.modes.bench import run as bench

    bench.run(json, quick=quick, cold=cold, stages=stages)
