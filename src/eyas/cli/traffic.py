"""`eyas traffic`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from eyas.cli.options import ConfigFile, MapName, Overrides, Preset, chosen_file, gathered

__all__ = ["app"]

app = typer.Typer(help="Record traffic with SUMO.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command()
def record(  # noqa: PLR0913  # one parameter for each option
    map_name: MapName = None,
    map_seed: Annotated[int | None, typer.Option("--map-seed", help="Seed of the map.")] = None,
    seed: Annotated[
        int | None, typer.Option("--seed", help="Seed of SUMO and of the routes.")
    ] = None,
    duration: Annotated[float, typer.Option("--duration", help="Seconds to record.")] = 1260.0,
    vehicle_type: Annotated[
        str | None, typer.Option("--type", help="passenger, bus, truck, trailer or motorcycle.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="File to write.")] = None,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace the file.")] = False,
    config: ConfigFile = None,
    preset: Preset = None,
    set_: Overrides = None,
    canonical: Annotated[
        bool,
        typer.Option(
            "--canonical",
            help="Regenerate the files that ship with the map: its roads and its recordings.",
        ),
    ] = False,
) -> None:
    """Record traffic; use it with --set traffic.recording=FILE."""
    from eyas.modes import traffic
    from eyas.settings.file import load_settings
    from eyas.settings.legacy.messages import originals_named

    short = {
        "world.seed": map_seed,
        "traffic.seed": seed,
        "traffic.vehicle_type": vehicle_type,
    }
    said = [f"{key}={json.dumps(value)}" for key, value in short.items() if value is not None]
    settings = load_settings(chosen_file(config, preset), [*gathered(set_, map_name), *said])
    with originals_named(settings):
        if canonical:
            traffic.run_canonical(settings.world)
        else:
            traffic.run(settings.world, settings.traffic, duration, out, overwrite=overwrite)
