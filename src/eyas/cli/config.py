"""`eyas config`."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eyas.cli.options import ConfigFile, Overrides, Preset, chosen_file, gathered

if TYPE_CHECKING:
    from eyas.settings.config import EyasConfig

__all__ = ["app"]

app = typer.Typer(help="Show and convert settings.", no_args_is_help=True)


@app.callback()
def _group() -> None: ...


@app.command()
def show(
    config: ConfigFile = None,
    preset: Preset = None,
    set_: Overrides = None,
    legacy: Annotated[
        bool, typer.Option("--legacy", help="In the format of the DAT benchmark's env_config.json.")
    ] = False,
) -> None:
    """Check the settings, and print all of them as JSON."""
    from eyas.settings.file import load_settings
    from eyas.settings.legacy.messages import originals_named
    from eyas.settings.trust import code_of
    from eyas.world.maps import MAPS

    # Nothing that the file names is imported here, so it may be anyone's.
    settings = load_settings(chosen_file(config, preset), gathered(set_), trust=True)
    if ":" not in settings.world.map:  # code of the user's is not run to show settings
        with originals_named(settings):
            MAPS.get(settings.world.map).light(settings.world.weather)
    for setting, name in code_of(settings):
        typer.echo(f"eyas: note: {setting} names code, which a run calls: {name!r}", err=True)
    typer.echo(_text(settings, legacy=legacy))


@app.command()
def convert(
    source: Annotated[Path, typer.Argument(help="Settings to read, in either notation.")],
    target: Annotated[Path, typer.Argument(help="File to write; it must not exist.")],
    set_: Overrides = None,
) -> None:
    """Convert settings between the native and the DAT benchmark's notation."""
    from eyas.core.errors import OutputError
    from eyas.core.files import write_atomic
    from eyas.settings.file import load_settings, read_settings
    from eyas.settings.legacy.adapter import is_legacy

    if target.exists():
        raise OutputError(f"{target}: already exists; settings files are never overwritten")
    legacy = not is_legacy(read_settings(source))
    text = _text(load_settings(source, gathered(set_), trust=True), legacy=legacy)
    write_atomic(target, f"{text}\n".encode())


def _text(settings: "EyasConfig", *, legacy: bool) -> str:
    from eyas.settings.legacy.adapter import to_legacy

    if legacy:
        return json.dumps(to_legacy(settings), indent=4)
    return settings.model_dump_json(indent=2)
