"""What is done with recordings and data sets: `eyas export`, `eyas dataset`, `eyas track`."""

import logging
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from eyas.engine.core.errors import ConfigError
from eyas.engine.terminal.options import (
    SEVERAL,
    Out,
    Overrides,
    Overwrite,
    Plots,
    Private,
    PushToHub,
    Quiet,
    Ray,
    Resume,
    Shard,
    Workers,
    apart,
    parsed_shard,
    refuse_both,
    to_write,
)

if TYPE_CHECKING:
    from eyas.engine.exports.hub import HubRepository


def export(
    recording: Annotated[
        Path, typer.Argument(help="Folder of a recording, or of a data set.", show_default=False)
    ],
    formats: Annotated[
        list[str],
        typer.Option(
            "--format",
            help=f"coco, mot, ..., see docs/exports.md, or package.module:Class; {SEVERAL}.",
        ),
    ],
    out: Annotated[
        Path | None, to_write("Folder of the exports; by default RECORDING/exports.")
    ] = None,
    copy: Annotated[
        bool, typer.Option("--copy/--link", help="Copy the pictures, or make hard links to them.")
    ] = False,
    least_side: Annotated[
        int,
        typer.Option(
            "--least-side", min=1, help="Ignore objects narrower or lower than so many pixels."
        ),
    ] = 1,
    least_visible: Annotated[
        float,
        typer.Option(
            "--least-visible", min=0.0, max=1.0, help="Ignore objects of which less is visible."
        ),
    ] = 0.0,
    ignore_parked: Annotated[
        bool,
        typer.Option("--ignore-parked", help="Ignore parked cars and whatever else never moves."),
    ] = False,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Export a recording in the formats of other tools: COCO, MOTChallenge, GOT-10k, YOLO, ..."""
    from eyas.engine.recordings.run import run

    refuse_both(resume=resume, overwrite=overwrite)
    if math.isnan(least_visible):
        raise ConfigError("--least-visible: nan is not allowed: 0 to 1")
    from eyas.engine.recordings.export import ExportOptions

    options = ExportOptions(
        copies=copy,
        least_side=least_side,
        least_visible=least_visible,
        ignore_parked=ignore_parked,
        resume=resume,
        overwrite=overwrite,
    )
    run(recording, formats, out, options, quiet=quiet)


def track(
    recording: Annotated[
        Path,
        typer.Argument(
            help="Folder of a recording, of a data set or of sequences (GOT-10k, OTB, LaSOT, "
            "UAV123, VOT, MOT, VisDrone, DTB70, UAVDT, ...), or a film.",
            show_default=False,
        ),
    ],
    tracker: Annotated[
        str,
        typer.Option(
            "--tracker",
            "--policy",
            help="csrt, kcf, mosse, medianflow, nano, stay, a detector's .onnx file, or "
            "package.module:Class.",
        ),
    ],
    out: Annotated[
        Path | None, to_write("Folder to write to; by default runs/track/<data>-<tracker>.")
    ] = None,
    split: Annotated[
        str | None, typer.Option("--split", help="Only train, val or test of a data set.")
    ] = None,
    only: Annotated[
        str | None,
        typer.Option("--only", metavar="PATTERN", help="Only sequences of such names, as 'car*'."),
    ] = None,
    truth: Annotated[
        Path | None,
        typer.Option("--truth", help="File of the true boxes of a film or a folder of pictures."),
    ] = None,
    box: Annotated[
        str | None,
        typer.Option(
            "--box",
            metavar="LEFT,TOP,WIDTH,HEIGHT",
            help="The target in the first picture, in pixels, where there is no truth: boxes and a "
            "film are the result.",
        ),
    ] = None,
    restarts: Annotated[
        bool,
        typer.Option("--restarts", help="After a failure, give the tracker the true box again."),
    ] = False,
    workers: Workers = None,
    plots: Plots = False,
    resume: Resume = False,
    overwrite: Overwrite = False,
    quiet: Quiet = False,
) -> None:
    """Score a box tracker on recordings or sequences, or let it follow a box through a film."""
    from eyas.benchmark.report.plots import require_matplotlib
    from eyas.datasets.tracking.report import draw_curves, print_figures
    from eyas.datasets.tracking.run import Scoring, parsed_box, run

    refuse_both(resume=resume, overwrite=overwrite)
    if plots:
        require_matplotlib()  # not only when all is tracked
    name = Path(tracker.rpartition(":")[2]).stem.lower()
    folder = out or Path("runs/track") / f"{recording.resolve().name}-{name}"
    results = run(
        Scoring(
            tracker,
            recording,
            split,
            restarts,
            only,
            truth,
            None if box is None else parsed_box(box),
        ),
        folder,
        workers=workers,
        resume=resume,
        overwrite=overwrite,
        quiet=quiet,
    )
    if plots:
        draw_curves(folder, results)
    if not quiet:
        print_figures(folder, results)


dataset_app = typer.Typer(no_args_is_help=True, help="Make data sets from recipes.")


@dataset_app.command("make")
def make_dataset(
    recipe: Annotated[str, typer.Argument(help="detect, follow, sot, or a JSON file.")] = "detect",
    out: Annotated[str, to_write("Folder to write to.")] = "runs/dataset",
    frames: Annotated[
        int | None, typer.Option("--frames", min=1, help="Number of all frames.")
    ] = None,
    classes: Annotated[
        list[str] | None,
        typer.Option(
            "--classes",
            metavar="NAMES",
            help="What is followed: car, bus, truck, trailer, motorcycle, person; several with "
            "commas. Vehicles other than cars: on the maps whose recorded traffic has them.",
        ),
    ] = None,
    weather: Annotated[
        list[str] | None,
        typer.Option("--weather", metavar="NAMES", help="Its weathers; several with commas."),
    ] = None,
    map_name: Annotated[
        list[str] | None,
        typer.Option("--map", metavar="NAMES", help="Only these of its maps; with commas."),
    ] = None,
    formats: Annotated[
        list[str] | None,
        typer.Option("--format", metavar="NAMES", help="Further formats of eyas export."),
    ] = None,
    set_: Overrides = None,
    workers: Workers = None,
    sample: Annotated[
        bool, typer.Option("--sample", help="Make a hundredth, to look at it first.")
    ] = False,
    shard: Shard = None,
    ray: Ray = False,
    trust: Annotated[
        bool, typer.Option("--trust", help="Let the recipe name code, which is then run.")
    ] = False,
    push_to_hub: PushToHub = None,
    private: Private = False,
    resume: Resume = False,
    quiet: Quiet = False,
) -> None:
    """Record a data set with all cores, export and describe it."""
    from eyas.datasets.asked import Asked
    from eyas.datasets.making.make import Making
    from eyas.datasets.making.run import run

    if quiet:
        logging.getLogger("eyas").setLevel(logging.ERROR)
    if push_to_hub is not None and shard is not None:
        raise ConfigError(
            "--push-to-hub: not with --shard: merge the shards, then eyas dataset push"
        )
    # Before hours of work: whether the hub knows the user and takes the name.
    repository = None if push_to_hub is None else _repository(push_to_hub, private=private)
    making = Making(workers=workers, resume=resume, quiet=quiet)
    asked = Asked(
        frames,
        classes=apart(classes),
        weathers=apart(weather),
        maps=apart(map_name),
        formats=apart(formats),
        settings=tuple(set_ or ()),
    )
    run(
        recipe,
        out,
        making,
        asked=asked,
        sample=sample,
        shard=parsed_shard(shard),
        ray=ray,
        trust=trust,
    )
    if repository is not None:
        _push(Path(out), repository, quiet=quiet)


@dataset_app.command("push")
def push_dataset(
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Folder of a finished data set.")],
    repository: Annotated[
        str, typer.Argument(metavar="NAME", help="ACCOUNT/NAME on the Hugging Face hub.")
    ],
    private: Private = False,
    quiet: Quiet = False,
) -> None:
    """Publish a data set on the Hugging Face hub."""
    from eyas.datasets.hub import require_finished

    require_finished(folder)
    _push(folder, _repository(repository, private=private), quiet=quiet)


def _repository(name: str, *, private: bool) -> "HubRepository":
    from eyas.engine.exports.hub import HubRepository

    return HubRepository(name, "dataset", private=private or None)


def _push(folder: Path, repository: "HubRepository", *, quiet: bool) -> None:
    from eyas.datasets.hub import push

    push(folder, repository)
    if not quiet:
        typer.echo(repository.url)


@dataset_app.command("merge")
def merge_dataset(
    shards: Annotated[
        list[Path], typer.Argument(metavar="SHARD...", help="Folders of all shards, in any order.")
    ],
    out: Out,
    workers: Workers = None,
    resume: Resume = False,
    quiet: Quiet = False,
) -> None:
    """Join the shards of a data set, after checking that all are there and whole."""
    from eyas.datasets.making.make import Making
    from eyas.datasets.making.merge import merge

    if quiet:
        logging.getLogger("eyas").setLevel(logging.ERROR)
    merge(shards, out, Making(workers=workers, resume=resume, quiet=quiet))


@dataset_app.command("show")
def show_recipe(
    recipe: Annotated[
        str, typer.Argument(help="detect, follow, sot, or a JSON file.", show_default=False)
    ],
) -> None:
    """Print a recipe with all defaults, to make another of it."""
    from eyas.datasets.recipe import read_recipe

    typer.echo(read_recipe(recipe, trust=True).model_dump_json(indent=1))
