"""`eyas config`."""

import json
from typing import Annotated

import typer

from eyas.cli.options import ConfigFile, Overrides, gathered

__all__ = ["app"]

app = typer.Typer(help="Look at settings.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command()
def show(
    config: ConfigFile = None,
    set_: Overrides = None,
    legacy: Annotated[
        bool, typer.Option("--legacy", help="As the DAT benchmark's env_config.json.")
    ] = False,
) -> None:
    """Print settings as JSON, checked: every one and its value."""
    from eyas.sim.legacy import to_legacy
    from eyas.sim.settings_file import load_settings

    settings = load_settings(config, gathered(set_))
    if legacy:
        typer.echo(json.dumps(to_legacy(settings), indent=4))
    else:
        typer.echo(settings.model_dump_json(indent=2))
