"""Options that several commands share."""

import json
from pathlib import Path
from typing import Annotated

import typer

__all__ = ["ConfigFile", "MapName", "Overrides", "Seed", "Weather", "gathered"]

ConfigFile = Annotated[
    Path | None,
    typer.Option(
        "--config", help="Settings in JSON: native, or the DAT benchmark's env_config.json."
    ),
]
Overrides = Annotated[
    list[str] | None,
    typer.Option(
        "--set", metavar="KEY=VALUE", help="Change a setting; may be given several times."
    ),
]
MapName = Annotated[str | None, typer.Option("--map", help="Name of the map.")]
Weather = Annotated[str | None, typer.Option("--weather", help="Name of the weather.")]
Seed = Annotated[int | None, typer.Option("--seed", help="The one seed of the run.")]


def gathered(
    overrides: list[str] | None,
    map_name: str | None = None,
    weather: str | None = None,
    seed: int | None = None,
) -> list[str]:
    """Return all changes of settings as `key=value`; short options come last and so win."""
    short = {"world.map": map_name, "world.weather": weather, "seed": seed}
    said = [f"{key}={json.dumps(value)}" for key, value in short.items() if value is not None]
    return [*(overrides or []), *said]
