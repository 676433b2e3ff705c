"""`eyas webots-shim`."""

import os
from pathlib import Path
from typing import Annotated

import typer

from eyas.engine.terminal.options import Overrides, UntilIdle


def webots_shim(
    install: Annotated[
        Path, typer.Option("--install", help="Folder to write the program into, to be put in PATH.")
    ],
    root: Annotated[
        Path | None,
        typer.Option(
            "--root",
            help="Folder of the DAT benchmark; default: the one above the world file, or above the "
            "folder where the program is started.",
        ),
    ] = None,
    until_idle: UntilIdle = None,
    set_: Overrides = None,
) -> None:
    """Install a program named webots that starts 'eyas serve', for programs that start Webots."""
    from eyas.dat.serve.stand_in import install as write
    from eyas.engine.settings.file import load_settings

    load_settings(None, set_ or ())  # a mistake is told now
    path = write(install, root, set_ or (), until_idle)
    typer.echo(f"{path}: starts Eyas in the place of Webots where its folder comes first in PATH:")
    typer.echo(f'export PATH="{path.parent.resolve()}{os.pathsep}$PATH"')
