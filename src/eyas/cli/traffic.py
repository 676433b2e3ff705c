"""`eyas traffic`."""

from pathlib import Path
from typing import Annotated

import typer

from eyas.cli.options import ConfigFile, Overrides, gathered

__all__ = ["app"]

app = typer.Typer(help="Make traffic with SUMO.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command()
def record(
    map_name: Annotated[str, typer.Option("--map", help="Name of the map.")] = "citystreet",
    map_seed: Annotated[int, typer.Option("--map-seed", help="Seed of the map.")] = 0,
    seed: Annotated[int, typer.Option("--seed", help="Seed of SUMO and of the routes.")] = 1,
    duration: Annotated[float, typer.Option("--duration", help="Time to record [s].")] = 1260.0,
    vehicle_type: Annotated[
        str | None, typer.Option("--type", help="passenger, bus, truck, trailer or motorcycle.")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="File to write.")] = None,
    config: ConfigFile = None,
    set_: Overrides = None,
    canonical: Annotated[
        bool, typer.Option("--canonical", help="Make the recording that ships with the package.")
    ] = False,
) -> None:
    """Record traffic; use it with --set traffic.recording=FILE."""
    from eyas.modes import traffic
    from eyas.sim.settings_file import load_settings

    short = [f"world.map={map_name}", f"world.seed={map_seed}", f"traffic.seed={seed}"]
    if vehicle_type is not None:
        short.append(f"traffic.vehicle_type={vehicle_type}")
    settings = load_settings(config, [*gathered(set_), *short])
    if canonical:
        traffic.run_canonical(settings.world)
    else:
        traffic.run(settings.world, settings.traffic, duration, out)
