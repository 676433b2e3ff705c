"""What is done with recordings: `eyas export`."""

import math
from pathlib import Path
from typing import Annotated

import typer

from eyas.cli.options import SEVERAL

__all__ = ["export"]


def export(  # noqa: PLR0913  # one parameter for each option
    recording: Annotated[
        Path, typer.Argument(help="Folder of a recording, or of a data set.", show_default=False)
    ],
    formats: Annotated[
        list[str],
        typer.Option("--format", help=f"A format, or package.module:Class; {SEVERAL}."),
    ],
    out: Annotated[
        Path | None,
        typer.Option("--out", help="Folder of the exports; by default RECORDING/exports."),
    ] = None,
    copy: Annotated[
        bool,
        typer.Option("--copy/--link", help="Copy the pictures, or make hard links to them."),
    ] = False,
    least_side: Annotated[
        int,
        typer.Option("--least-side", min=1, help="Ignore objects that are smaller [pixels]."),
    ] = 1,
    least_visible: Annotated[
        float,
        typer.Option(
            "--least-visible", min=0.0, max=1.0, help="Ignore objects of which less is visible."
        ),
    ] = 0.0,
    resume: Annotated[
        bool, typer.Option("--resume", help="Continue an interrupted export.")
    ] = False,
    overwrite: Annotated[
        bool, typer.Option("--overwrite", help="First delete an export that is in the folder.")
    ] = False,
    quiet: Annotated[bool, typer.Option("--quiet", help="Print nothing but errors.")] = False,
) -> None:
    """Export a recording in the formats of other tools: COCO, MOTChallenge, GOT-10k, YOLO, ..."""
    from eyas.core.errors import ConfigError
    from eyas.modes.export import run

    if resume and overwrite:
        raise ConfigError("--overwrite and --resume cannot be used together")
    if math.isnan(least_visible):
        raise ConfigError("--least-visible: nan is not allowed: 0 to 1")
    from eyas.datasets.export import ExportOptions

    options = ExportOptions(copy, least_side, least_visible, resume, overwrite)
    run(recording, formats, out, options, quiet=quiet)
