"""`eyas serve`."""

from functools import partial
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
    root: Annotated[
        Path,
        typer.Option(
            "--root",
            help="Folder of the DAT benchmark, with Webots_Simulation and Alg_Base, or an empty "
            "one. Its env_config.json is used unless --config or --preset is given.",
        ),
    ],
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
) -> None:
    """Serve algorithm code of the DAT benchmark in the place of its simulator, until Ctrl-C."""
    from eyas.settings.config import Mode
    from eyas.settings.file import load_settings
    from eyas.settings.legacy.adapter import LIKE_THE_ORIGINAL
    from eyas.wire.exchange import SETTINGS_FILE

    file = chosen_file(config, preset)
    if file is None and (root / SETTINGS_FILE).exists():
        file = root / SETTINGS_FILE
    # The first start writes a file, which cannot tell all, and serves what the next will read.
    overrides = gathered(set_, map_name, weather, seed)
    load = partial(load_settings, file, overrides, base=LIKE_THE_ORIGINAL, trust=trust)
    settings = load()
    if settings.original is not None and settings.mode is not Mode.TRAIN:
        said = f"mode (Simulation_Mode) is '{settings.mode}'; 'eyas serve' trains anyway"
        typer.echo(f"eyas: note: {said}", err=True)
    from eyas.modes.serve.run import run  # after all checks

    run(settings, root, load if file == root / SETTINGS_FILE else None)
