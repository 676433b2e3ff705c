"""`eyas video`."""

import logging
from pathlib import Path
from typing import Annotated

import typer

from eyas.cli.options import (
    ConfigFile,
    MapName,
    Overrides,
    Preset,
    Seed,
    Trust,
    Weather,
    chosen_file,
    gathered,
)

__all__ = ["command"]


def command(  # noqa: PLR0913  # one parameter for each option
    out: Annotated[Path, typer.Option("--out", help="Folder to write to.")] = Path("runs/video"),
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted recording.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="First delete a recording that is in the folder.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Record labelled pictures and videos of trackers that follow their targets."""
    from eyas.settings.config import Mode
    from eyas.settings.file import load_settings

    if quiet:
        logging.getLogger("eyas").setLevel(logging.ERROR)
    overrides = gathered(set_, map_name, weather, seed)
    settings = load_settings(chosen_file(config, preset), overrides, trust=trust)
    if settings.mode is not Mode.VIDEO and not quiet:
        said = f"mode (Simulation_Mode) is '{settings.mode}'; 'eyas video' records anyway"
        typer.echo(f"eyas: note: {said}", err=True)
    from eyas.modes.video import (
        run as video,  # compiled kernels: slow to import, so only after all checks
    )

    video.run(settings, out, overwrite=overwrite, resume=resume, quiet=quiet)
