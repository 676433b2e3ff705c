"""`eyas train`."""

from pathlib import Path
from typing import Annotated

import typer

from eyas.cli.options import (
    ConfigFile,
    MapName,
    Overrides,
    Preset,
    Seed,
    Weather,
    chosen_file,
    gathered,
)

__all__ = ["command"]


def command(  # noqa: PLR0913  # one parameter for each option
    out: Annotated[Path, typer.Option("--out", help="Folder to write to.")] = Path("runs/train"),
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue an interrupted run.")] = False,
    ray: Annotated[
        bool,
        typer.Option("--ray", help="Spread the shards over a Ray cluster (extra cluster)."),
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Teach a network to track, and write it as an ONNX file."""
    from eyas.settings.file import load_settings

    preset = preset or (None if config else "fast")
    settings = load_settings(chosen_file(config, preset), gathered(set_, map_name, weather, seed))
    from eyas.modes.train import run

    policy = run(settings, out, resume=resume, quiet=quiet, ray=ray)
    if not quiet:
        typer.echo(f"{policy}")
