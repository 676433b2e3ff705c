"""`eyas train`."""

import json
from pathlib import Path
from typing import Annotated

import typer

from eyas.engine.terminal.ending import print_ending
from eyas.engine.terminal.options import (
    ConfigFile,
    MapName,
    Overrides,
    Preset,
    Quiet,
    Ray,
    Resume,
    Seed,
    Trust,
    Weather,
    chosen_file,
    gathered,
    to_write,
)


def train(
    out: Annotated[
        Path | None, to_write("Folder to write to; by default runs/train, runs/train-2, ...")
    ] = None,
    config: ConfigFile = None,
    preset: Preset = None,
    map_name: MapName = None,
    weather: Weather = None,
    seed: Seed = None,
    set_: Overrides = None,
    trust: Trust = False,
    method: Annotated[
        str | None,
        typer.Option(
            "--method",
            help="How to teach (train.method): ppo, dagger, dagger+ppo, tracker, words, pursuit, "
            "or package.module:Class.",
        ),
    ] = None,
    steps: Annotated[
        int | None,
        typer.Option(
            "--steps",
            min=1,
            help="Decisions of the whole run (of a tracker: pictures that it is taught with); "
            "stages keep their shares of it.",
        ),
    ] = None,
    device: Annotated[
        str | None,
        typer.Option(
            "--device",
            help="Where to fly and learn: cuda, cuda:1, ... (train.device); by default here.",
        ),
    ] = None,
    resume: Resume = False,
    ray: Ray = False,
    quiet: Quiet = False,
) -> None:
    """Teach a network to track, and write it as an ONNX file."""
    from eyas.engine.settings.file import load_settings

    preset = preset or (None if config else "fast")
    overrides = gathered(set_, map_name, weather, seed)
    if method is not None:
        overrides.append(f"train.method={json.dumps(method)}")
    if device is not None:
        overrides.append(f"train.device={json.dumps(device)}")
    settings = load_settings(chosen_file(config, preset), overrides, trust=trust)
    if steps is not None:
        from eyas.engine.core.config import updated
        from eyas.learning.config import TrainConfig

        settings = updated(settings, {"train": TrainConfig.of(settings).scaled(steps)})
    from eyas.learning.run import run

    policy = run(
        settings, out or _default_folder(resume=resume), resume=resume, quiet=quiet, ray=ray
    )
    if not quiet:
        print_ending(
            f"{policy} (its curve in {policy.with_name('curve.csv')})",
            ("measure it", ("eyas", "evaluate", "--policy", policy)),
            ("see it fly", ("eyas", "demo", "--policy", policy)),
        )


def _default_folder(*, resume: bool) -> Path:
    """Return the next numbered folder that is free, or the last that is not, to resume it."""
    taken, number = None, 1
    while (folder := Path(f"runs/train-{number}" if number > 1 else "runs/train")).exists():
        taken, number = folder, number + 1
    return taken if resume and taken is not None else folder
