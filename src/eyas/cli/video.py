"""`eyas video`."""

from pathlib import Path
from typing import Annotated

import typer

from eyas.cli.options import ConfigFile, MapName, Overrides, Seed, Weather, gathered

__all__ = ["command"]


def command(
    out: Annotated[Path, typer.Option("--out", help="Folder to write to.")] = Path("runs/video"),
    config: ConfigFile = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    resume: Annotated[
        bool, typer.Option("--resume", help="Go on with an interrupted recording.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="Delete a recording that is in the folder.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Record labelled pictures and films of trackers that follow their targets."""
    from eyas.sim.settings_file import load_settings

    settings = load_settings(config, gathered(set_, map_name, weather, seed))
    from eyas.modes import video  # compiled kernels: slow to import, so only when all is well

    video.run(settings, out, overwrite=overwrite, resume=resume, quiet=quiet)
